"""Reads what misbench writes: float R, G, B, uncompressed, by scanlines (OpenEXR file layout)."""
import struct


def read_exr(path):
    """(width, height, pixel), where pixel(x, y) is (red, green, blue)."""
    with open(path, "rb") as file:
        data = file.read()
    at = 8
    header = {}

    def text():
        nonlocal at
        end = data.index(b"\0", at)
        found = data[at:end].decode()
        at = end + 1
        return found

    while data[at]:
        name, _ = text(), text()
        size, = struct.unpack_from("<i", data, at)
        header[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    if header["compression"] != b"\0":
        raise ValueError(f"{path}: it is compressed")
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    at += 1 + 8 * height  # the end of the header, the table of offsets

    def pixel(x, y):
        # Each line: its number, its size, then its channels in the order of their names: B, G, R.
        line = at + y * (8 + 12 * width) + 8
        return tuple(struct.unpack_from("<f", data, line + 4 * (c * width + x))[0]
                     for c in (2, 1, 0))

    return width, height, pixel
