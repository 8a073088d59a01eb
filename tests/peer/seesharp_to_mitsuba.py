"""SeeSharp scenes for the independent renderer, where it knows their materials: Lambert and glass.

Meshes become OBJ files beside the new scene file.
"""

import json
import math
import pathlib
import shutil
import xml.etree.ElementTree as ElementTree

import numpy as np

# Pixels of the converted environment along one pixel of the original: SeeSharp's look-up is
# the nearest pixel, Mitsuba's is bilinear, so finer pixels make the soft seams narrow.
ENVIRONMENT_REFINEMENT = 3


def _add(parent, tag, name=None, value=None, **attributes):
    if name is not None:
        attributes["name"] = name
    if value is not None:
        attributes["value"] = value
    return ElementTree.SubElement(parent, tag, **attributes)


def _numbers(values):
    return " ".join(repr(float(value)) for value in values)


def _camera_to_world(transform):
    """position, rotation in degrees (Y X Z), scale; or a matrix of row vectors."""
    if "matrix" in transform:
        return np.array(transform["matrix"], float).reshape(4, 4).T

    def rotation(axis, degrees):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        i, j = [k for k in range(3) if k != axis]
        if axis == 1:
            i, j = j, i
        matrix = np.eye(4)
        matrix[i, i] = matrix[j, j] = c
        matrix[i, j], matrix[j, i] = -s, s
        return matrix

    x, y, z = transform.get("rotation", (0, 0, 0))
    move = np.eye(4)
    move[:3, 3] = transform.get("position", (0, 0, 0))
    scale = np.diag([*transform.get("scale", (1, 1, 1)), 1.0])
    return move @ rotation(1, y) @ rotation(0, x) @ rotation(2, z) @ scale


def _add_sensor(root, scene):
    camera = scene["cameras"][-1]
    transform = next(t for t in scene["transforms"] if t["name"] == camera["transform"])
    # SeeSharp looks along -z with x to the right, Mitsuba along +z with x to the left.
    to_world = _camera_to_world(transform) @ np.diag([-1.0, 1.0, -1.0, 1.0])
    sensor = _add(root, "sensor", type="perspective")
    _add(sensor, "string", "fov_axis", "y")
    _add(sensor, "float", "fov", repr(camera["fov"]))
    _add(_add(sensor, "transform", "to_world"), "matrix", value=_numbers(to_world.ravel()))
    _add(sensor, "film", type="hdrfilm")


def _add_bsdf(parent, material, folder):
    color = material["baseColor"]
    if material.get("type") != "diffuse":
        glass = material.get("specularTransmittance", 0) == 1 and material.get("roughness", 1) == 0
        if not glass:
            raise ValueError(f"material '{material['name']}': neither diffuse nor smooth glass")
        bsdf = _add(parent, "bsdf", type="dielectric")
        _add(bsdf, "float", "int_ior", repr(material["IOR"]))
        _add(bsdf, "float", "ext_ior", "1")
        return
    bsdf = _add(_add(parent, "bsdf", type="twosided"), "bsdf", type="diffuse")
    if color["type"] == "rgb":
        _add(bsdf, "rgb", "reflectance", _numbers(color["value"]))
    else:
        texture = _add(bsdf, "texture", "reflectance", type="bitmap")
        _add(texture, "string", "filename", str(folder / color["filename"]))
        _add(texture, "string", "filter_type", "nearest")


def _add_shape(root, file, material, emission, folder):
    shape = _add(root, "shape", type="obj")
    _add(shape, "string", "filename", str(file))
    _add_bsdf(shape, material, folder)
    if any(emission):
        _add(_add(shape, "emitter", type="area"), "rgb", "radiance", _numbers(emission))


def _write_trimesh(mesh, file):
    def rows(name, n):
        return np.array(mesh.get(name, ()), float).reshape(-1, n)

    lines = [f"v {_numbers(p)}" for p in rows("vertices", 3)]
    lines += [f"vn {_numbers(n)}" for n in rows("normals", 3)]
    lines += [f"vt {u!r} {1 - v!r}" for u, v in rows("uv", 2).tolist()]
    uv = "{0}" if mesh.get("uv") else ""
    normal = "/{0}" if mesh.get("normals") else ""
    corner = "{0}" + (f"/{uv}{normal}" if uv or normal else "")
    for triangle in np.array(mesh["indices"]).reshape(-1, 3) + 1:
        lines.append("f " + " ".join(corner.format(i) for i in triangle))
    file.write_text("\n".join(lines) + "\n")


def _split_obj(source, stem):
    """One OBJ file for each material: yields its name and file."""
    shared, faces, material = [], {}, None
    for line in source.read_text().splitlines():
        keyword = line.split(" ", 1)[0]
        if keyword in ("v", "vt", "vn"):
            shared.append(line)
        elif keyword == "usemtl":
            material = line.split(" ", 1)[1].strip()
        elif keyword == "f":
            faces.setdefault(material, []).append(line)
    for index, (name, lines) in enumerate(faces.items()):
        file = stem.with_name(f"{stem.name}-{index}.obj")
        file.write_text("\n".join(shared + lines) + "\n")
        yield name, file


def _add_environment(root, source, file):
    """Looks up the nearest pixel: u = φ/2π from +X towards +Z, v = θ/π from +Y."""
    from mitsuba_side import read_image, write_exr

    original = read_image(source)
    height, width = (ENVIRONMENT_REFINEMENT * n for n in original.shape[:2])
    # Mitsuba: columns at pixel centres, from -Z towards +X; the first and last row are the poles.
    phi = 2 * np.pi * (np.arange(width) + 0.5) / width
    column = np.arctan2(-np.cos(phi), np.sin(phi)) / (2 * np.pi) % 1 * original.shape[1]
    row = np.arange(height) / (height - 1) * original.shape[0]
    row = np.minimum(row.astype(int), original.shape[0] - 1)
    write_exr(file, original[row][:, np.minimum(column.astype(int), original.shape[1] - 1)])
    emitter = _add(root, "emitter", type="envmap")
    _add(emitter, "string", "filename", str(file))


def convert(source, target):
    """Writes the Mitsuba scene file `target`, and meshes beside it."""
    source, target = pathlib.Path(source).resolve(), pathlib.Path(target)
    target.parent.mkdir(parents=True, exist_ok=True)
    scene = json.loads(source.read_text())
    root = ElementTree.Element("scene", version="3.0.0")
    _add_sensor(root, scene)
    materials = {material["name"]: material for material in scene["materials"]}
    for index, item in enumerate(scene["objects"]):
        stem = target.with_name(f"{target.stem}-{index}")
        if item["type"] == "trimesh":
            file = stem.with_suffix(".obj")
            _write_trimesh(item, file)
            meshes = [(item["material"], file)]
        elif item["type"] == "obj":
            meshes = _split_obj(source.parent / item["relativePath"], stem)
        else:
            raise ValueError(f"object '{item['name']}': type '{item['type']}' is not converted")
        for name, file in meshes:
            emission = item.get("emission") or materials[name].get("emission") or {}
            _add_shape(root, file, materials[name], emission.get("value", (0,)), source.parent)
    if "background" in scene:
        image = source.parent / scene["background"]["filename"]
        _add_environment(root, image, target.with_name(f"{target.stem}-environment.exr"))
    ElementTree.ElementTree(root).write(target, encoding="utf-8", xml_declaration=True)


def write_lambert_only(source, target):
    """Copies a SeeSharp scene file and what lies beside it; every material becomes diffuse."""
    source, target = pathlib.Path(source).resolve(), pathlib.Path(target)
    shutil.copytree(source.parent, target.parent, dirs_exist_ok=True)
    scene = json.loads(source.read_text())
    for material in scene["materials"]:
        kept = ("name", "baseColor", "emission")
        changed = {key: material[key] for key in kept if key in material} | {"type": "diffuse"}
        material.clear()
        material.update(changed)
    target.write_text(json.dumps(scene, indent=1))
