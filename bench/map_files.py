"""COLMAP's map files as arrays of float32, channels x height x width."""
import numpy as np


def read_map(path):
    width, height, channels, values = path.read_bytes().split(b"&", 3)
    return np.frombuffer(values, "<f4").reshape(int(channels), int(height), int(width))


def write_map(path, values):
    """Of values without channels, too."""
    height, width = values.shape[-2:]
    channels = values.size // (height * width)
    path.write_bytes(f"{width}&{height}&{channels}&".encode() + values.astype("<f4").tobytes())
