#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""manual_test.py PROGRAM FOLDER: the manual page and the completion that were built have every command and option of
--help, and every command has examples."""

import pathlib
import re
import shutil
import subprocess
import sys


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def completions(folder, *words):
    """Of the last word on a command line."""
    return output("bash", "-c", f"""source {folder}/cinch.bash
        COMP_WORDS=(cinch {' '.join(words)}); COMP_CWORD={len(words)}; _cinch
        printf "%s\\n" "${{COMPREPLY[@]}}" """).split()


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    manual = (folder / "cinch.1").read_text()
    plain = manual.replace("\\-", "-").replace("\\e", "\\")
    commands = re.findall(r"^  (\w[\w-]*) {2,}\S", output(program, "--help").split("Subcommands:")[1].split("\n\n")[0],
                          re.M)
    assert len(commands) >= 11, commands
    for command in commands:
        section = re.search(rf"^\.SS cinch {command} .*?(?=^\.SS|\Z)", plain, re.M | re.S)
        assert section, f"no section of '{command}'"
        text = output(program, command, "--help")
        assert "Examples:\n  cinch " in text, f"'{command} --help' has no example"
        assert max(map(len, text.splitlines())) <= 80, f"'{command} --help' is wider than 80 columns"
        for line in text.splitlines()[1:]:
            words = line.split()
            there = all(word in section.group() for word in words if not word.endswith(":"))
            assert line.startswith("  -h") or there, (command, line)
        for option in re.findall(r"^  (--[a-z0-9-]+)", text, re.M):
            assert option in completions(folder, command, option), (command, option)
    assert set(commands) <= set(completions(folder, '""'))
    assert {"6", "14", "18", "26"} == set(completions(folder, "verify", "--kdop", '""'))
    assert "best" in completions(folder, "verify", "--method", "b")
    assert {"brain", "brain-3500", "brain-pull"} <= set(completions(folder, "verify", "brain"))
    assert "help" in completions(folder, "he")
    for section in ("EXIT STATUS", "FILES", "ENVIRONMENT", "SEE ALSO"):
        assert f"\n.SH {section}\n" in manual, section
    if shutil.which("man"):
        shown = subprocess.run(["man", "--warnings=w", "-l", str(folder / "cinch.1")], capture_output=True, text=True)
        assert shown.returncode == 0 and not shown.stderr, shown.stderr
    print(f"{len(commands)} commands")


if __name__ == "__main__":
    main()
