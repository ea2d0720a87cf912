# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a certificate: exact readings of texts, and doubles as whole numbers times a power of two."""
import json
import math
import re
import sys

WEIGHT_BITS = 53
ONE = 1 << WEIGHT_BITS
MOST_INDEX = (1 << 32) - 1
GREATEST = sys.float_info.max


class Rejected(Exception):
    """Why a certificate proves nothing."""


def require(condition, message, *values):
    if not condition:
        raise Rejected(message.format(*values))


def shown(value):
    """A value for a message: one short line of ASCII."""
    text = json.dumps(value) if isinstance(value, str) else ascii(value)
    return text if len(text) <= 60 else text[:57] + "..."


def whole(value, least, most, what):
    require(type(value) is int and least <= value <= most,
            "{} is {}, not a whole number from {} to {}", what, shown(value), least, most)
    return value


def listed(value, length, what):
    require(type(value) is list and (length is None or len(value) == length),
            "{} is no list{}", what, "" if length is None else f" of {length}")
    return value


def in_order(what, index, wanted):
    require(type(index) is int and index == wanted, "{} {} where {} should follow", what, shown(index), wanted)


def text(value, what):
    require(type(value) is str, "{} is {}, not a text", what, shown(value))
    return value


NORMAL = re.compile(r"-?0x1(?:\.[0-9a-f]{1,13})?p[+-][0-9]{1,4}").fullmatch
HEXADECIMAL = re.compile(r"[+-]?0x([0-9a-f]*)\.?([0-9a-f]*)(?:p([+-]?[0-9]{1,6}))?", re.IGNORECASE).fullmatch
LEAST_NORMAL = sys.float_info.min


def double(value):
    """The finite double that a hexadecimal float spells exactly."""
    if type(value) is str and len(value) < 1200:
        try:
            if NORMAL(value):  # at most 53 bits
                x = float.fromhex(value)
                if x >= LEAST_NORMAL or x <= -LEAST_NORMAL:
                    return x
            spelt = HEXADECIMAL(value)
            if spelt and (spelt[1] or spelt[2]):
                units, exponent = int(spelt[1] + spelt[2], 16), int(spelt[3] or 0) - 4 * len(spelt[2])
                zeros = (units & -units).bit_length() - 1 if units else 0
                if not units or ((units >> zeros).bit_length() <= 53 and exponent + zeros >= -1074 and
                                 exponent + units.bit_length() <= 1024):
                    return float.fromhex(value)
        except OverflowError:
            pass
    raise Rejected(f"{shown(value)} is no hexadecimal float whose value is a double")


# An extremum is a sum of products of two doubles: below 2^2060, in units of at least 2^-2150, so under 1,300 digits.
RATIO = re.compile(r"(-?[0-9]{1,1500})/([0-9]{1,1500})").fullmatch


def double_or_ratio(value):
    """Numerator and denominator > 0."""
    ratio = RATIO(value) if type(value) is str else None
    if not ratio:
        return double(value).as_integer_ratio()
    p, q = int(ratio[1]), int(ratio[2])
    require(q > 0, "the denominator of {} is 0", shown(value))
    return p, q


def weight_units(value):
    """A positive weight as a whole number of 2^-53, and as the double."""
    weight = double(value)
    units = weight * ONE
    require(1 <= units <= ONE and units == int(units),
            "weight {} is no positive multiple of 2^-53 up to 1", shown(value))
    return int(units), weight


def bits_after_point(x):
    return x.as_integer_ratio()[1].bit_length() - 1


def scaled(x, bits):
    """x * 2^bits, a whole number."""
    p, q = x.as_integer_ratio()
    return p << (bits - (q.bit_length() - 1))


def least_doubles(units, bits):
    """The least doubles that are at least +x and -x, x = units * 2^-bits: a double is at least x if and only if it is
    at least the first."""
    try:
        nearest = units / (1 << bits)
    except OverflowError:
        return (math.inf, -GREATEST) if units > 0 else (-GREATEST, math.inf)
    p, q = nearest.as_integer_ratio()
    difference = (p << bits) - units * q
    above = nearest if difference >= 0 else math.nextafter(nearest, math.inf)
    below = nearest if difference <= 0 else math.nextafter(nearest, -math.inf)
    return above, -below


def plain(name):
    """A name of whatever characters, on one line."""
    return name if name.isprintable() else json.dumps(name)[1:-1]
