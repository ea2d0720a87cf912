#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""manual.py PROGRAM FOLDER: writes cinch.1, the manual page, and cinch.bash, the completion, from what --help says."""

import pathlib
import re
import subprocess
import sys


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout


def parsed(text):
    """Title, usage, [(section, [(entry, description)])] and footer of one help text."""
    title, usage, rest = re.match(r"(.*?)\nUsage: (.*?)\n\n(.*)", text, re.S).groups()
    sections, lines = [], rest.splitlines()
    while lines and re.fullmatch(r"(Positionals|Options|Subcommands):", lines[0]):
        entries = []
        name = lines.pop(0)[:-1]
        while lines and lines[0].startswith("  "):
            line = lines.pop(0)
            entry, description = line[:30].strip(), line[30:].strip()
            if not line.startswith("   ") and len(line) > 30 and line[29] != " ":  # too wide for its column
                entry, description = (re.split(r"\s{2,}", line.strip(), maxsplit=1) + [""])[:2]
            if entry:
                entries.append([entry, description])
            else:
                entries[-1][1] += " " + description
        sections.append((name, entries))
        while lines and not lines[0].strip():
            lines.pop(0)
    return title.strip(), usage, sections, "\n".join(lines).strip()


def roff(text):
    out = text.replace("\\", "\\e").replace("-", "\\-")
    return "\n".join("\\&" + line if line.startswith((".", "'")) else line for line in out.split("\n"))


def entries_of(sections, wanted):
    return [entry for name, entries in sections if name in wanted for entry in entries]


def preformatted(text):
    return f".nf\n{roff(text)}\n.fi\n" if text else ""


def manual(program):
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.split()[1]
    title, _, sections, footer = parsed(help_of(program))
    footer, status = footer.split("\n\nExit status:\n")
    commands = entries_of(sections, {"Subcommands"})
    out = [f'.TH CINCH 1 "" "cinch {version}" "User Commands"\n.SH NAME\n{roff(title.replace(": ", " - ", 1))}\n',
           ".SH SYNOPSIS\n.B cinch\n.I COMMAND\n[\\fIOPTIONS\\fR]\n.br\n.B cinch\n.I COMMAND\n.B \\-\\-help\n",
           f".SH DESCRIPTION\n{roff(footer)}\n.SH OPTIONS\n"]
    for entry, description in entries_of(sections, {"Options"}):
        out.append(f".TP\n.B {roff(entry)}\n{roff(description)}\n")
    out.append(".SH COMMANDS\n")
    for command, _ in commands:
        title, usage, sections, footer = parsed(help_of(program, command))
        out.append(f".SS {roff(usage)}\n{roff(title[:1].upper() + title[1:])}.\n")
        for entry, description in entries_of(sections, {"Positionals", "Options"}):
            if not entry.startswith("-h,"):
                out.append(f".TP\n.B {roff(entry)}\n{roff(description)}\n")
        out.append(".PP\n" + preformatted(footer))
    out.append(".SH EXIT STATUS\n" + preformatted(status))
    return "".join(out)


COMPLETION = """# SPDX-License-Identifier: GPL-3.0-or-later
# bash completion for cinch; made from its --help
_cinch()
{
    local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} words=
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ]; then
        COMPREPLY=($(compgen -W "@COMMANDS@ --help --version" -- "$word"))
        return
    fi
    case $command in
@CASES@    esac
    case $word in
    -*) COMPREPLY=($(compgen -W "$words" -- "$word")) ;;
    esac
}
complete -o bashdefault -o default -F _cinch cinch
"""


def completion(program):
    commands = entries_of(parsed(help_of(program))[2], {"Subcommands"})
    cases = ""
    for command, _ in commands:
        options = [word for entry, _ in entries_of(parsed(help_of(program, command))[2], {"Options"})
                   for word in re.findall(r"--[a-z0-9-]+", entry.split(" Excludes")[0])]
        cases += f"    {command}) words=\"{' '.join(options)}\" ;;\n"
    return COMPLETION.replace("@COMMANDS@", " ".join(name for name, _ in commands)).replace("@CASES@", cases)


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "cinch.1").write_text(manual(program))
    (folder / "cinch.bash").write_text(completion(program))


if __name__ == "__main__":
    main()
