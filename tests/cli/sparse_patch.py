"""Changes to the binary sparse model of a scene, byte by byte."""
import struct


def image_records(data):
    """(offset of the record, offset of the name, offset of the points) per image."""
    records = []
    offset = 8
    for _ in range(struct.unpack_from("<Q", data, 0)[0]):
        name = offset + 64
        points = data.index(b"\0", name) + 1
        records.append((offset, name, points))
        offset = points + 8 + 24 * struct.unpack_from("<Q", data, points)[0]
    return records


def set_pose_value(path, image, index, value):
    """index 0..6: qw qx qy qz tx ty tz."""
    data = bytearray(path.read_bytes())
    struct.pack_into("<d", data, image_records(data)[image][0] + 4 + 8 * index, value)
    path.write_bytes(data)


def copy_pose(path, source, target):
    data = bytearray(path.read_bytes())
    records = image_records(data)
    a, b = records[source][0] + 4, records[target][0] + 4
    data[b : b + 56] = data[a : a + 56]
    path.write_bytes(data)


def _rotated(q, v):
    """v turned by the quaternion (w, x, y, z)."""
    w, x, y, z = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [
        v[0] + w * t[0] + y * t[2] - z * t[1],
        v[1] + w * t[1] + z * t[0] - x * t[2],
        v[2] + w * t[2] + x * t[1] - y * t[0],
    ]


def transform_model(folder, scale=1, shift=(0, 0, 0)):
    """World x becomes scale * x + shift."""
    path = folder / "images.bin"
    data = bytearray(path.read_bytes())
    for begin, _, _ in image_records(data):
        pose = struct.unpack_from("<7d", data, begin + 4)
        away = _rotated(pose[:4], shift)
        t = [scale * pose[4 + k] - away[k] for k in range(3)]
        struct.pack_into("<3d", data, begin + 36, *t)
    path.write_bytes(data)
    path = folder / "points3D.bin"
    data = bytearray(path.read_bytes())
    offset = 8
    for _ in range(struct.unpack_from("<Q", data, 0)[0]):
        xyz = struct.unpack_from("<3d", data, offset + 8)
        struct.pack_into("<3d", data, offset + 8, *(scale * x + s for x, s in zip(xyz, shift)))
        offset += 51 + 8 * struct.unpack_from("<Q", data, offset + 43)[0]
    path.write_bytes(data)


def rename_image(path, image, name):
    """`name` as bytes, of any length."""
    data = path.read_bytes()
    _, begin, points = image_records(data)[image]
    path.write_bytes(data[:begin] + name + b"\0" + data[points:])


def set_camera_value(path, camera, index, value):
    """index 0..3: fx fy cx cy of a PINHOLE camera."""
    data = bytearray(path.read_bytes())
    struct.pack_into("<d", data, 8 + 56 * camera + 24 + 8 * index, value)
    path.write_bytes(data)


def set_camera_sizes(path, width, height):
    """Of all cameras, which must have four parameters each."""
    data = bytearray(path.read_bytes())
    for camera in range(struct.unpack_from("<Q", data, 0)[0]):
        struct.pack_into("<QQ", data, 8 + 56 * camera + 8, width, height)
    path.write_bytes(data)


def remove_observations(path):
    data = path.read_bytes()
    out = data[:8]
    for begin, _, points in image_records(data):
        out += data[begin:points] + struct.pack("<Q", 0)
    path.write_bytes(out)


def remove_points(folder):
    """No sparse points at all, and no observations of them."""
    (folder / "points3D.bin").write_bytes(struct.pack("<Q", 0))
    remove_observations(folder / "images.bin")


def thin_tracks(folder, keep):
    """Keeps the track elements (point number, image id) that `keep` accepts; all points stay."""
    path = folder / "points3D.bin"
    data = path.read_bytes()
    count = struct.unpack_from("<Q", data, 0)[0]
    out, offset = data[:8], 8
    for point in range(count):
        length = struct.unpack_from("<Q", data, offset + 43)[0]
        begin = offset + 51
        elements = [data[begin + 8 * i : begin + 8 * i + 8] for i in range(length)]
        kept = [e for e in elements if keep(point, struct.unpack_from("<I", e)[0])]
        out += data[offset : offset + 43] + struct.pack("<Q", len(kept)) + b"".join(kept)
        offset = begin + 8 * length
    path.write_bytes(out)
    remove_observations(folder / "images.bin")
