"""PNG files of any content, without an imaging library."""
import struct
import zlib


def _chunk(kind, data):
    body = kind + data
    return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))


def png(width, height, rows, bits=8):
    """A grey picture; `rows` are its bytes, two per pixel with bits=16."""
    step = width * bits // 8
    raw = b"".join(b"\0" + rows[step * y : step * (y + 1)] for y in range(height))
    return (
        b"\x89PNG\r\n\x1a\n"
        + _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0))
        + _chunk(b"IDAT", zlib.compress(raw))
        + _chunk(b"IEND", b"")
    )


def bomb(width, height):
    """A valid header of a huge picture, with next to nothing behind it."""
    return (
        b"\x89PNG\r\n\x1a\n"
        + _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
        + _chunk(b"IDAT", zlib.compress(bytes(1000)))
        + _chunk(b"IEND", b"")
    )


def constant(width, height, grey):
    return png(width, height, bytes([grey]) * (width * height))


def decode16(data):
    """The values of a picture of sixteen bits."""
    _, _, _, raw = decode(data, 16)
    return [v for (v,) in struct.iter_unpack(">H", raw)]


def decode(data, expected_bits=8):
    """(width, height, channels, bytes) of a grey or colour picture."""
    at, packed = 8, b""
    while at < len(data):
        length = int.from_bytes(data[at : at + 4], "big")
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    assert bits == expected_bits
    channels = {0: 1, 2: 3}[color]
    n = channels * bits // 8
    raw = zlib.decompress(packed)
    rows, above = [], bytes(width * n)
    for y in range(height):
        begin = y * (width * n + 1)
        line = bytearray(raw[begin + 1 : begin + 1 + width * n])
        for x in range(width * n):
            a, b = (line[x - n] if x >= n else 0), above[x]
            c = above[x - n] if x >= n else 0
            p = a + b - c
            predicted = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            line[x] = (line[x] + (0, a, b, (a + b) // 2, predicted)[raw[begin]]) & 255
        above = bytes(line)
        rows.append(above)
    return width, height, channels, b"".join(rows)
