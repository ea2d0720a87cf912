# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of the text, those that change nothing among them."""
import gzip
import json
import random
import re

from certificate_forge import of
from certificate_mutations import HARMLESS, MUTATIONS, harmless, lower, text_of


def line_changed(name, reason, change, which=7):
    def of_records(records):
        lines = [json.dumps(r) for r in records]
        lines[which] = change(lines[which])
        return lines
    MUTATIONS[name] = of_records, reason


line_changed("a key twice, the same", 'the key "vertex" stands twice', lambda s: s.replace("{", '{"vertex": 6, ', 1))
line_changed("a key twice in the header, the first one wrong", 'the key "method" stands twice',
             lambda s: s.replace("{", '{"method": "vertices", ', 1), 0)
line_changed("a key twice in a hash", 'the key "positions" stands twice',
             lambda s: s.replace('"sha256": {', '"sha256": {"positions": "", '), 0)
line_changed("a key twice, spelt in two ways", 'the key "bounds" stands twice',
             lambda s: s.replace("{", '{"\\u0062ounds": [], ', 1), -2)
line_changed("an array", "no JSON object", lambda s: f"[{s}]")
line_changed("a comma too many", "not JSON", lambda s: s.replace("}", ",}"))
line_changed("NaN as a number", "only whole numbers", lambda s: s.replace('"vertex": 6', '"vertex": NaN'))
line_changed("a number of 5,000 digits", "not JSON", lambda s: s.replace('"vertex": 6', '"vertex": ' + "6" * 5000))
line_changed("two records on a line", "not JSON", lambda s: s + s)
line_changed("nested deeply", "nested too deeply", lambda s: "[" * 200000)
line_changed("nested deeply within", "nested too deeply",
             lambda s: s.replace('"vertex": 6', '"vertex": ' + '{"a":' * 100000))
line_changed("a tab in a key", "not JSON", lambda s: s.replace("vertex", "ver\tex"))
line_changed("half a line", "not JSON", lambda s: s[:len(s) // 2])
MUTATIONS["not UTF-8"] = (lambda records: text_of(records).replace(b"vertex", b"\xff\xfe", 1)), "not UTF-8"
MUTATIONS["UTF-16"] = (lambda records: text_of(records).decode().encode("utf-16")), "not UTF-8"
MUTATIONS["a byte order mark"] = (lambda records: b"\xef\xbb\xbf" + text_of(records)), "not JSON"
MUTATIONS["zero bytes"] = (lambda records: b"\0" * 100), "not JSON"
MUTATIONS["an empty file"] = (lambda records: b""), "the file ends where a header should follow"
MUTATIONS["the header alone"] = (lambda records: text_of(records[:1])), "the file ends where vertex 0 should follow"
MUTATIONS["cut in the middle"] = (lambda records: text_of(records)[:len(text_of(records)) // 2]), ""
for name, damage, reason in (
    ("cut in the middle", lambda data: data[:-500], "not readable"),
    ("cut before its last bytes", lambda data: data[:-3], "not readable"),
    ("with a wrong sum", lambda data: data[:-8] + b"\1\2\3\4" + data[-4:], "not readable"),
    ("and more behind", lambda data: data + b"more", "not readable"),
    ("no more than its first bytes", lambda data: data[:2], "not readable"),
    ("a damaged block", lambda data: data[:40] + b"\xff" * 40 + data[80:], ""),
):
    MUTATIONS[f"gzip, {name}"] = (lambda records, damage=damage: damage(gzip.compress(text_of(records)))), reason


# ---- what changes nothing --------------------------------------------------------------------------------------------

@harmless
def order_of_keys(records):
    rng = random.Random(3)
    return [dict(rng.sample(list(r.items()), len(r))) for r in records]


@harmless
def spaces_and_empty_lines(records):
    return b"\n" + text_of(records, separators=("  ,\t", " :  ")).replace(b"\n", b" \r\n\n  \n")


@harmless
def no_spaces_and_no_last_line_end(records):
    return text_of(records, separators=(",", ":"))[:-1]


@harmless
def compression_by_gzip(records):
    return text_of(records)


@harmless
def compression_by_gzip_in_two_parts(records):
    data = text_of(records)
    return gzip.compress(data[:1000], 9) + gzip.compress(data[1000:], 1)


@harmless
def escapes(records):
    return text_of(records).replace(b'"vertex"', b'"\\u0076ertex"').replace(b'"0x', b'"\\u0030x')


def respelt(spell):
    def change(records):
        return [re.sub(r'"(-?)0x([0-9a-f.]+)p([+-]\d+)"', lambda m: f'"{spell(m[0][1:-1])}"', json.dumps(r))
                for r in records]
    return change


HARMLESS["doubles with all their digits"] = respelt(lambda x: float.fromhex(x).hex())
HARMLESS["doubles in capitals"] = respelt(str.upper)
HARMLESS["doubles with more zeros"] = respelt(
    lambda x: x.replace("0x", "0x000").replace("p", "0000p" if "." in x else ".0000p"))
@respelt
def as_a_whole_number(x):
    p, q = float.fromhex(x).as_integer_ratio()
    return f"{'-' if x[0] == '-' else ''}0x{abs(p):x}p{1 - q.bit_length()}"


HARMLESS["doubles as whole numbers"] = as_a_whole_number


@harmless
def lambdas_as_ratios(records):
    for i in of(records, "lambda"):
        records[i]["lambda"] = [x if "/" in x else "{}/{}".format(*(7 * n for n in float.fromhex(x).as_integer_ratio()))
                                for x in records[i]["lambda"]]
    return records


@harmless
def higher_bounds(records):
    for i in of(records, "bounds"):
        records[i]["bounds"] = [lower(-0.25)(x) for x in records[i]["bounds"]]
    return records
