#!/usr/bin/env python3
"""Makes the images and meshes that the scenes in experiments/scenes/features refer to.

    make_feature_files.py FOLDER

The files are small, have no symmetry, so that a flip or a rotation shows, and are the same bytes
every time. Needs only the standard library.
"""

import array
import math
import pathlib
import struct
import sys
import zlib


def write_png(path, rows):
    """rows: top row first; a pixel is (r, g, b), 0 to 255."""

    def chunk(name, data):
        return (
            struct.pack(">I", len(data))
            + name
            + data
            + struct.pack(">I", zlib.crc32(name + data))
        )

    pixels = b"".join(b"\0" + bytes(value for rgb in row for value in rgb) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(pixels, 9))
        + chunk(b"IEND", b"")
    )


def panel(x, y):
    """An F on a gradient, with a red mark in the top left corner."""
    stem = 4 <= x <= 5 and 2 <= y <= 12
    bars = (4 <= x <= 11 and 2 <= y <= 3) or (4 <= x <= 9 and 7 <= y <= 8)
    if x < 2 and y < 2:
        return (230, 40, 30)
    if stem or bars:
        return (30, 60, 160)
    return (120 + 6 * x, 200 - 8 * y, 90)


def write_pfm(path, width, height, radiance):
    """Rows of a PFM file run from the bottom to the top."""
    values = array.array("f")
    for y in reversed(range(height)):
        for x in range(width):
            values.extend(radiance((x + 0.5) / width, (y + 0.5) / height))
    if sys.byteorder == "big":
        values.byteswap()
    path.write_bytes(b"PF\n%d %d\n-1.0\n" % (width, height) + values.tobytes())


def sky(u, v):
    """Blue above, brown below, a broad warm sun and a smaller green lamp elsewhere."""

    def lobe(center_u, center_v, width):
        du = (u - center_u + 0.5) % 1 - 0.5
        return math.exp(-(du * du + (v - center_v) ** 2) / (2 * width * width))

    up = max(0, math.cos(math.pi * v))
    down = max(0, -math.cos(math.pi * v))
    sun = 12 * lobe(0.7, 0.28, 0.05)
    lamp = 5 * lobe(0.15, 0.45, 0.03)
    return (
        0.15 + 0.2 * up + 0.1 * down + sun,
        0.15 + 0.3 * up + 0.05 * down + 0.8 * sun + lamp,
        0.15 + 0.7 * up + 0.5 * sun,
    )


N_SIDE = 7  # vertices along one side of the bump


def bump():
    """A smooth hill over [-1, 1]²: positions, normals, uvs (v upwards), triangles."""
    positions, normals, uvs, triangles = [], [], [], []
    for j in range(N_SIDE):
        for i in range(N_SIDE):
            x, y = 2 * i / (N_SIDE - 1) - 1, 2 * j / (N_SIDE - 1) - 1
            height = 0.5 * math.exp(-2 * ((x - 0.2) ** 2 + y * y))
            slope = (4 * (x - 0.2) * height, 4 * y * height, 1.0)
            length = math.sqrt(sum(s * s for s in slope))
            positions.append((x, y, height))
            normals.append(tuple(s / length for s in slope))
            uvs.append((i / (N_SIDE - 1), j / (N_SIDE - 1)))
    for j in range(N_SIDE - 1):
        for i in range(N_SIDE - 1):
            corner = j * N_SIDE + i
            triangles.append((corner, corner + 1, corner + N_SIDE + 1))
            triangles.append((corner, corner + N_SIDE + 1, corner + N_SIDE))
    return positions, normals, uvs, triangles


def write_obj(path, with_normals):
    positions, normals, uvs, triangles = bump()
    lines = ["v %.6f %.6f %.6f" % p for p in positions]
    lines += ["vt %.6f %.6f" % uv for uv in uvs]
    if with_normals:
        lines += ["vn %.6f %.6f %.6f" % n for n in normals]
    corner = "%d/%d/%d" if with_normals else "%d/%d"
    for triangle in triangles:
        n_indices = 3 if with_normals else 2
        lines.append("f " + " ".join(corner % ((i + 1,) * n_indices) for i in triangle))
    path.write_text("\n".join(lines) + "\n")


def write_ply(path):
    """With v downwards, as a bitmap's rows run."""
    positions, normals, uvs, triangles = bump()
    properties = "".join(f"property float {name}\n" for name in "x y z nx ny nz u v".split())
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(positions)}\n{properties}"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    data = b"".join(
        struct.pack("<8f", *p, *n, u, 1 - v) for p, n, (u, v) in zip(positions, normals, uvs)
    )
    data += b"".join(struct.pack("<B3i", 3, *triangle) for triangle in triangles)
    path.write_bytes(header.encode() + data)


def write_serialized(path):
    """Two meshes in Mitsuba's own format, version 4: a flat triangle, then the bump."""
    has_normals, has_uvs, single_precision = 0x1, 0x2, 0x1000

    def mesh(name, positions, normals, uvs, triangles):
        data = struct.pack("<I", has_normals | has_uvs | single_precision)
        data += name.encode() + b"\0"
        data += struct.pack("<QQ", len(positions), len(triangles))
        data += b"".join(struct.pack("<3f", *p) for p in positions)
        data += b"".join(struct.pack("<3f", *n) for n in normals)
        data += b"".join(struct.pack("<2f", u, 1 - v) for u, v in uvs)
        data += b"".join(struct.pack("<3I", *t) for t in triangles)
        return struct.pack("<HH", 0x041C, 4) + zlib.compress(data, 9)

    triangle = (
        [(-1, -1, 0), (1, -1, 0), (0, 1, 0)],
        [(0, 0, 1)] * 3,
        [(0, 0), (1, 0), (0.5, 1)],
        [(0, 1, 2)],
    )
    meshes = [mesh("triangle", *triangle), mesh("bump", *bump())]
    offsets = struct.pack("<2Q", 0, len(meshes[0]))
    path.write_bytes(b"".join(meshes) + offsets + struct.pack("<I", len(meshes)))


def main(folder):
    write_png(folder / "panel.png", [[panel(x, y) for x in range(16)] for y in range(16)])
    write_pfm(folder / "sky.pfm", 64, 32, sky)
    write_obj(folder / "bump.obj", with_normals=True)
    write_obj(folder / "bump_without_normals.obj", with_normals=False)
    write_ply(folder / "bump.ply")
    write_serialized(folder / "bump.serialized")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: make_feature_files.py FOLDER")
    main(pathlib.Path(sys.argv[1]))
