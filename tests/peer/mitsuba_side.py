"""The independent renderer: chooses its variant, sets up scenes for comparison, renders them."""

import glob
import os
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np

NEVER = 1_000_000  # depth of Russian roulette: paths end by max_depth alone
MAX_WAVEFRONT = 1 << 23  # samples in flight: bounds the memory of the vectorised variant

_PROBE = """
import mitsuba, numpy
mitsuba.set_variant("llvm_ad_rgb")
numpy.array(mitsuba.render(mitsuba.load_dict(mitsuba.cornell_box()), spp=1))
"""


def _llvm_libraries():
    """The one the environment names, then what is installed, the newest version first."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    if named:
        return [named]
    found = glob.glob("/usr/lib/*/libLLVM*.so*") + glob.glob("/usr/lib/llvm-*/lib/libLLVM*.so*")
    versions = {}
    for path in found:
        version = re.search(r"libLLVM[-.](?:so\.)?(\d+)", path)
        if version:
            versions.setdefault(int(version.group(1)), path)
    return [versions[version] for version in sorted(versions, reverse=True)]


def choose_variant():
    """Sets the fastest variant that works here and returns its name.

    Not every LLVM can compile for every processor, and then it ends the process: so another process
    tries.
    """
    import mitsuba

    variant = "scalar_rgb"
    for library in _llvm_libraries():
        environment = os.environ | {"DRJIT_LIBLLVM_PATH": library}
        probe = subprocess.run([sys.executable, "-c", _PROBE], env=environment, capture_output=True)
        if probe.returncode == 0:
            os.environ["DRJIT_LIBLLVM_PATH"] = library
            variant = "llvm_ad_rgb"
            break
    mitsuba.set_variant(variant)
    return variant


def _replace_film_settings(film, size):
    for child in list(film):
        name = child.get("name", "")
        if child.tag == "rfilter":
            film.remove(child)
        if size and (name in ("width", "height") or name.startswith("crop_")):
            film.remove(child)
    if size:
        for name, value in zip(("width", "height"), size):
            ElementTree.SubElement(film, "integer", name=name, value=str(value))
    ElementTree.SubElement(film, "rfilter", type="box")


def write_comparable(source, target, size):
    """Copies a scene file; filter, sampler, integrator and, where given, the size become ours."""
    tree = ElementTree.parse(source)
    root = tree.getroot()
    for integrator in root.findall("integrator"):
        root.remove(integrator)
    for sensor in root.findall("sensor"):
        for sampler in sensor.findall("sampler"):
            sensor.remove(sampler)
        ElementTree.SubElement(sensor, "sampler", type="independent")
        for film in sensor.findall("film"):
            _replace_film_settings(film, size)
    folder = pathlib.Path(source).resolve().parent
    for node in root.iter("string"):
        if node.get("name") == "filename":
            node.set("value", str(folder / node.get("value")))
    target.parent.mkdir(parents=True, exist_ok=True)
    tree.write(target, encoding="utf-8", xml_declaration=True)


class MitsubaScene:
    """REQUIRES: choose_variant() was called."""

    def __init__(self, file):
        import mitsuba

        self._scene = mitsuba.load_file(str(file))
        width, height = self._scene.sensors()[0].film().crop_size()
        self.size = (int(width), int(height))

    def render(self, max_depth, n_samples, seed):
        """The mean of n_samples a pixel: height × width × 3."""
        import mitsuba

        integrator = mitsuba.load_dict(
            {"type": "path", "max_depth": max_depth, "rr_depth": NEVER}
        )
        n_at_once = max(1, MAX_WAVEFRONT // (self.size[0] * self.size[1]))
        total, n_done = 0, 0
        while n_done < n_samples:
            n = min(n_at_once, n_samples - n_done)
            image = mitsuba.render(
                self._scene, integrator=integrator, spp=n, seed=seed * 100_000 + n_done
            )
            total = total + n * np.array(image, dtype=np.float64)[..., :3]
            n_done += n
        return total / n_samples


def read_image(file):
    import mitsuba

    bitmap = mitsuba.Bitmap(str(file)).convert(
        mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.Float32, False
    )
    return np.array(bitmap, dtype=np.float64)


def read_alpha(file):
    """The alpha channel as a grey image: height × width × 3."""
    import mitsuba

    bitmap = mitsuba.Bitmap(str(file)).convert(
        mitsuba.Bitmap.PixelFormat.RGBA, mitsuba.Struct.Type.Float32, False
    )
    return np.repeat(np.array(bitmap, dtype=np.float64)[..., 3:], 3, axis=2)


def write_exr(file, image):
    import mitsuba

    mitsuba.Bitmap(image.astype(np.float32)).write(str(file))


def write_png(file, image):
    """Of linear values, encoded as sRGB; what is above 1 is cut off."""
    import mitsuba

    bitmap = mitsuba.Bitmap(np.clip(image, 0, 1).astype(np.float32))
    bitmap.convert(mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.UInt8, True).write(str(file))
