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
