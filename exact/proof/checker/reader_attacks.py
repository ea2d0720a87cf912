# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done to the text of a certificate to have a reader take it for another: name -> (change, verdict)."""
import re

ACCEPTED, REJECTED = 0, 1
ATTACKS = {}


def attack(name, wanted, change):
    ATTACKS[name] = change, wanted


def swapped(old, new, count=1):
    """The first places of a text; it must be there."""
    def change(data):
        assert old in data, old
        return data.replace(old, new, count)
    return change


def number(name, wanted, spelt):
    """A bound, the first of the last record that has any, in another spelling; `spelt` of its text."""
    def change(data):
        at = data.rindex(b'"bounds": ["') + len(b'"bounds": ["')
        end = data.index(b'"', at)
        return data[:at] + spelt(data[at:end]) + data[end:]
    attack(name, wanted, change)


# ---- ends of the file and of lines
attack("blank lines after the end", ACCEPTED, lambda data: data + b"\n \t\r\n\x0b\x0c\n")
attack("blank lines of other blanks before", ACCEPTED, lambda data: b"\x0b\x0c\r\n" + data)
attack("no line end", ACCEPTED, lambda data: data.rstrip(b"\n"))
attack("line ends of DOS", ACCEPTED, lambda data: data.replace(b"\n", b"\r\n"))
attack("line ends of an old Macintosh", REJECTED, lambda data: data.replace(b"\n", b"\r"))
attack("a zero byte after the end", REJECTED, lambda data: data + b"\0")
attack("a zero byte before a line end", REJECTED, swapped(b"}\n", b"}\0\n"))
attack("something after the end on its line", REJECTED, lambda data: data.rstrip(b"\n") + b" x\n")
attack("null after the end", REJECTED, lambda data: data + b"null\n")
attack("the whole certificate twice", REJECTED, lambda data: data + data)
attack("cut before the last brace", REJECTED, lambda data: data.rstrip(b"\n")[:-1])
attack("cut by a line", REJECTED, lambda data: data[:data.rstrip(b"\n").rindex(b"\n") + 1])
attack("two records on a line, with a comma", REJECTED, swapped(b"}\n{", b"}, {"))
attack("a record over two lines", REJECTED, swapped(b'{"vertex": 3, ', b'{"vertex": 3,\n'))
attack("a separator of lines of Unicode", REJECTED, swapped(b"}\n", b"}\xe2\x80\xa8"))
attack("blanks of Unicode", REJECTED, swapped(b'{"vertex": 3,', b'{"vertex":\xc2\xa03,'))

# ---- keys
attack("a key twice, the second one right", REJECTED, swapped(b'{"vertex": 3', b'{"vertex": 4, "vertex": 3'))
attack("a key twice, escaped", REJECTED, swapped(b'"nodes": [', b'"node\\u0073": [], "nodes": ['))
attack("a key in capitals", REJECTED, swapped(b'"bounds"', b'"Bounds"'))
attack("a key with a zero", REJECTED, swapped(b'"bounds"', b'"bounds\\u0000"'))
attack("an escaped key", ACCEPTED, swapped(b'"bounds"', b'"\\u0062oun\\u0064s"'))
attack("an empty key", REJECTED, swapped(b'{"vertex"', b'{"": 0, "vertex"'))
attack("two hashes", REJECTED, swapped(b'"sha256": {', b'"sha256": {}, "sha256": {'))
attack("an escape that is none", REJECTED, swapped(b'"vertex"', b'"vert\\ex"'))
attack("half an escape", REJECTED, swapped(b'"vertex"', b'"vert\\u006"'))

# ---- whole numbers
for spelt, wanted in ((b'"3"', REJECTED), (b"3.0", REJECTED), (b"3e0", REJECTED), (b"30e-1", REJECTED),
                      (b"03", REJECTED), (b"+3", REJECTED), (b"0x3", REJECTED), (b"3 ", ACCEPTED), (b"[3]", REJECTED),
                      (b"true", REJECTED), (b"null", REJECTED), (b"NaN", REJECTED), (b"Infinity", REJECTED),
                      (b"-3", REJECTED), (b"4294967299", REJECTED), (b"18446744073709551619", REJECTED),
                      (b"9223372036854775811", REJECTED), (b"3" * 5000, REJECTED), (b"", REJECTED), (b"-", REJECTED),
                      (b"3_0", REJECTED), (b"\xd9\xa3", REJECTED)):
    attack(f"vertex: {spelt[:30]}", wanted, swapped(b'"vertex": 3,', b'"vertex": ' + spelt + b","))
attack("minus zero", ACCEPTED, swapped(b'"vertex": 0,', b'"vertex": -0,'))
attack("a count as a text", REJECTED, lambda data: re.sub(rb'"proven": (\d+)', rb'"proven": "\1"', data))
attack("a count as a float", REJECTED, lambda data: re.sub(rb'"proven": (\d+)', rb'"proven": \1.0', data))
attack("a count and 2^64", REJECTED, lambda data: re.sub(
    rb'"proven": (\d+)', lambda m: b'"proven": %d' % (int(m[1]) + 2**64), data))
attack("violated is a truth value", REJECTED, swapped(b'"violated": 0', b'"violated": false'))
attack("violated is a text", REJECTED, swapped(b'"violated": 0', b'"violated": ""'))
attack("a vertex that is not whole", REJECTED, swapped(b'"vertices": [0, ', b'"vertices": [0.0, '))
attack("a vertex of 2^32", REJECTED, swapped(b'"vertices": [0, ', b'"vertices": [4294967296, '))

# ---- doubles
for name, wanted, spelt in (
    ("itself with a plus", ACCEPTED, lambda x: b"+" + x if x[:1] != b"-" else x),
    ("in capitals", ACCEPTED, lambda x: x.upper()),
    ("a decimal", REJECTED, lambda x: b"1e300"),
    ("inf", REJECTED, lambda x: b"inf"),  # the counts are others
    ("minus infinity", REJECTED, lambda x: b"-inf"),
    ("plus infinity", REJECTED, lambda x: b"+inf"),
    ("Inf", REJECTED, lambda x: b"Inf"),
    ("infinity", REJECTED, lambda x: b"infinity"),
    ("nan", REJECTED, lambda x: b"nan"),
    ("a huge exponent", REJECTED, lambda x: b"0x1p+99999"),
    ("an exponent that wraps in 64 bits", REJECTED, lambda x: b"0x1p+18446744073709551626"),
    ("an exponent of 7 digits", REJECTED, lambda x: b"0x1p+0000010"),
    ("an exponent of 6 digits", ACCEPTED, lambda x: b"0x1p+001000"),
    ("the greatest double", ACCEPTED, lambda x: b"0x1.fffffffffffffp+1023"),
    ("beyond the greatest double", REJECTED, lambda x: b"0x1.fffffffffffff8p+1023"),
    ("2^1024", REJECTED, lambda x: b"0x1p+1024"),
    ("2^1023 by many digits", ACCEPTED, lambda x: b"0x8" + b"0" * 255),
    ("2^1024 by many digits", REJECTED, lambda x: b"0x1" + b"0" * 256),
    ("too many digits", REJECTED, lambda x: b"0x" + b"0" * 1200 + b"1p+100"),
    ("zeros before", ACCEPTED, lambda x: b"0x" + b"0" * 1000 + b"1p+100"),
    ("zeros after the point", ACCEPTED, lambda x: b"0x1." + b"0" * 1000 + b"p+100"),
    ("54 bits", REJECTED, lambda x: b"0x1.00000000000008p+100"),
    ("no digits", REJECTED, lambda x: b"0xp+100"),
    ("a point alone", REJECTED, lambda x: b"0x.p+100"),
    ("a point first", ACCEPTED, lambda x: b"0x.8p+100"),
    ("a point last", ACCEPTED, lambda x: b"0x8.p+100"),
    ("two points", REJECTED, lambda x: b"0x1..8p+100"),
    ("no exponent", ACCEPTED, lambda x: b"0xfffff"),
    ("half an exponent", REJECTED, lambda x: b"0x1p"),
    ("an exponent of a sign", REJECTED, lambda x: b"0x1p+"),
    ("two signs", REJECTED, lambda x: b"--0x1p+100"),
    ("no prefix", REJECTED, lambda x: b"1p+100"),
    ("a blank before", REJECTED, lambda x: b" 0x1p+100"),
    ("a blank after", REJECTED, lambda x: b"0x1p+100 "),
    ("a line end after", REJECTED, lambda x: b"0x1p+100\\n"),
    ("a zero after", REJECTED, lambda x: b"0x1p+100\\u0000"),
    ("digits that are not ASCII", REJECTED, lambda x: "0x1p+١٠٠".encode()),
    ("capitals that are not ASCII", REJECTED, lambda x: "0Ⅹ1p+100".encode()),
    ("a decimal point of the mantissa's exponent", REJECTED, lambda x: b"0x1p+1.5"),
    ("underscores", REJECTED, lambda x: b"0x1_0p+100"),
    ("a suffix", REJECTED, lambda x: b"0x1p+100L"),
    ("a ratio", REJECTED, lambda x: b"1000/1"),
    ("a bound below, beside the real one", REJECTED, lambda x: x + b'", "-0x1p+100'),
):
    number(f"a bound: {name}", wanted, spelt)
attack("an infinite bound as a number", REJECTED,
       lambda data: re.sub(rb'"bounds": \["[^"]*"', b'"bounds": [1e999', data, count=1))
attack("bounds as an object", REJECTED,
       lambda data: re.sub(rb'"bounds": \[("[^"]*"), ', rb'"bounds": [{"x": \1}, ', data, count=1))
attack("minus zero as time", REJECTED, swapped(b'"time": "0x0.0p+0"', b'"time": "-0x0p+0"'))  # the hash is another
attack("time as a number", REJECTED, swapped(b'"time": "0x0.0p+0"', b'"time": 0'))
attack("zero in other words", ACCEPTED, swapped(b'"time": "0x0.0p+0"', b'"time": "0x0.000p-99999"'))

# ---- texts
attack("a clip with escapes", ACCEPTED, swapped(b'"clip": "made"', b'"clip": "\\u006d\\u0061de"'))
attack("a clip of another case", REJECTED, swapped(b'"clip": "made"', b'"clip": "Made"'))
attack("a clip that is not UTF-8", REJECTED, swapped(b'"clip": "made"', b'"clip": "made\xff"'))
attack("a clip of an overlong character", REJECTED, swapped(b'"clip": "made"', b'"clip": "m\xc1\xa1de"'))
attack("a clip of a surrogate in UTF-8", REJECTED, swapped(b'"clip": "made"', b'"clip": "\xed\xa0\x80"'))
attack("a line end within a text", REJECTED, swapped(b'"clip": "made"', b'"clip": "ma\tde"'))
attack("partial as a text", REJECTED, swapped(b'"partial": false', b'"partial": "false"'))
attack("missing as null", REJECTED, swapped(b'"missing": []', b'"missing": null'))
