# SPDX-License-Identifier: Apache-2.0
"""Integers that all units share, as docs/numbers.md defines them."""
from typing import NamedTuple


class Reciprocal(NamedTuple):
    """1 / value is about mantissa * 2^-(width + exponent)."""
    mantissa: int
    exponent: int


def clog2(value: int) -> int:
    """⌈log2 value⌉ of a value of at least 1 (docs/numbers.md, "Words")."""
    return (value - 1).bit_length()


def reciprocal(value: int, width: int) -> Reciprocal:
    """The named operation `reciprocal` of a value of at least 1, W = width (docs/numbers.md, "Reciprocal")."""
    exponent = value.bit_length() - 1
    # value / 2^exponent lies in [1, 2); its mantissa has `width` bits behind the point, rounded half up.
    mantissa = ((value << (width + 1)) + (1 << exponent)) >> (exponent + 1)
    if mantissa == 2 << width:
        mantissa >>= 1
        exponent += 1
    return Reciprocal((1 << 2 * width) // mantissa, exponent)


def unfold(x: int, y: int, size: int) -> tuple[int, int, int]:
    """The point of the octahedron |x| + |y| + |z| = size that lies at (x, y) of the square [-size, size]^2
    (docs/numbers.md, "Octahedral codes")."""
    z = size - abs(x) - abs(y)
    if z >= 0:
        return x, y, z
    return (size - abs(y) if x >= 0 else abs(y) - size), (size - abs(x) if y >= 0 else abs(x) - size), z


def oct_decode(u: int, v: int, bits: int) -> tuple[int, int, int]:
    """o(u, v), the centre of a cell of 2^bits x 2^bits, unnormalised (docs/numbers.md, "Octahedral codes")."""
    size = 1 << bits
    return unfold(2 * u + 1 - size, 2 * v + 1 - size, size)


def hilbert_index(x: int, y: int, z: int, bits: int) -> int:
    """Index of a cell of 2^bits along each axis on the Hilbert curve (docs/numbers.md, "Hilbert index")."""
    axes = [x, y, z]
    for level in range(bits - 1, 0, -1):
        below = (1 << level) - 1
        for axis in range(3):
            if axes[axis] >> level & 1:
                axes[0] ^= below
            else:
                swapped = (axes[0] ^ axes[axis]) & below
                axes[0] ^= swapped
                axes[axis] ^= swapped
    axes[1] ^= axes[0]
    axes[2] ^= axes[1]
    flips = 0
    for level in range(bits - 1, 0, -1):
        if axes[2] >> level & 1:
            flips ^= (1 << level) - 1
    index = 0
    for level in range(bits - 1, -1, -1):
        for axis in range(3):
            index = index << 1 | (axes[axis] ^ flips) >> level & 1
    return index
