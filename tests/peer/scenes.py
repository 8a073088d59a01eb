"""The scenes that are compared, and what is known to differ."""

import dataclasses
import pathlib
import xml.etree.ElementTree as ElementTree

import seesharp_to_mitsuba

SOURCE_FOLDER = pathlib.Path(__file__).resolve().parents[2]
SCENE_FOLDER = SOURCE_FOLDER / "experiments" / "scenes"

# Scenes in which a difference is expected, and why. README.md tells how large each is.
DOCUMENTED_DIFFERENCES = {}


def same_file(file, _folder):
    return file, file


def seesharp(file, folder):
    """A SeeSharp scene of materials that both know."""
    converted = folder / f"{file.stem}.xml"
    seesharp_to_mitsuba.convert(file, converted)
    return file, converted


def seesharp_lambert(file, folder):
    """A SeeSharp scene with every material replaced by Lambert's, for both."""
    lambert = folder / "lambert" / file.name
    seesharp_to_mitsuba.write_lambert_only(file, lambert)
    return seesharp(lambert, folder)


def living_room(file, folder):
    """Leaves out what one of the two does not know, for both; still of the dialect 0.6.

    Mitsuba 3 has no roughdiffuse, strictNormals, trilinear filter, extEta nor film gamma, and takes
    the luminance of a bitmap for the opacity where this scene means its alpha channel.
    """
    from mitsuba_side import read_alpha, write_png

    tree = ElementTree.parse(file)
    root = tree.getroot()
    unknown = ("strictNormals", "extEta", "gamma", "banner")
    for parent in list(root.iter()):
        for child in list(parent):
            rough = parent.get("type") == "roughdiffuse" and child.get("name") == "alpha"
            if child.get("name") in unknown or rough:
                parent.remove(child)
    for node in root.iter():
        if node.get("type") == "roughdiffuse":
            node.set("type", "diffuse")
        if node.get("value") == "trilinear":
            node.set("value", "bilinear")
        if node.get("name") == "filename":
            node.set("value", str(file.resolve().parent / node.get("value")))
    folder.mkdir(parents=True, exist_ok=True)
    for texture in root.iter("texture"):
        if texture.get("name") == "opacity":
            name = texture.find("string[@name='filename']")
            opacity = folder / "opacity.png"
            write_png(opacity, read_alpha(name.get("value")))
            name.set("value", str(opacity.resolve()))
    derived = folder / "scene.xml"
    tree.write(derived, encoding="utf-8", xml_declaration=True)
    return derived, derived


@dataclasses.dataclass(frozen=True)
class PeerScene:
    name: str
    file: pathlib.Path
    max_depth: int  # edges of the longest path, the camera edge included: the same in both
    size: tuple | None = None  # None: the file's
    n_samples: int = 128  # a pixel and seed
    n_seeds: int = 16
    prepare: object = same_file  # (file, folder) → the file for misbench, and the one for Mitsuba

    @property
    def documented(self):
        return DOCUMENTED_DIFFERENCES.get(self.name)


def _feature(file):
    depth = ElementTree.parse(file).find("integrator/integer[@name='max_depth']")
    return PeerScene(f"features/{file.stem}", file, int(depth.get("value")))


def all_scenes():
    def scene(name, file, *arguments, **settings):
        return PeerScene(name, SCENE_FOLDER / file, *arguments, **settings)

    whole = [
        scene("cornell-box", "cornell-box/scene.xml", 30, (128, 128)),
        scene("veach-mis", "veach-mis/scene.xml", 5, (192, 108), n_samples=512),
        scene("veach-bidir", "veach-bidir/scene.xml", 7, (128, 128), n_samples=512),
        scene("veach-bidir/scene_features", "veach-bidir/scene_features.xml", 12, (128, 128),
              n_samples=512),
        scene("living-room", "living-room/scene.xml", 8, (192, 108), n_seeds=8,
              prepare=living_room),
        scene("CornellBox", "CornellBox/CornellBox.json", 8, (128, 128), prepare=seesharp),
        scene("TextureTest", "TextureTest/TextureTest.json", 4, (128, 96), prepare=seesharp),
        scene("SeeSharpBasics/simpledi", "SeeSharpBasics/simpledi.json", 4, (128, 96),
              prepare=seesharp_lambert),
        scene("SeeSharpBasics/simplebackground", "SeeSharpBasics/simplebackground.json", 4,
              (128, 96), prepare=seesharp_lambert),
        scene("Box/LightTop", "Box/LightTop.json", 3, (128, 96), n_samples=512,
              prepare=seesharp_lambert),
    ]
    return whole + [_feature(file) for file in sorted((SCENE_FOLDER / "features").glob("*.xml"))]
