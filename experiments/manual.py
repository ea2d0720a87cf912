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
    for section, entries in (("FILES", FILES), ("ENVIRONMENT", ENVIRONMENT)):
        out.append(f".SH {section}\n")
        out += [f".TP\n.I {roff(entry)}\n{roff(description)}\n" for entry, description in entries]
    out.append(".SH SEE ALSO\n.BR gnuplot (1),\n.BR sbatch (1)\n")
    return "".join(out)


FILES = [("NAME.XXXXXX.part", "An output that is not whole yet; it becomes NAME, or goes when the command ends."),
         ("DIR/shard-I-of-N.jsonl", "What a shard has finished (--out DIR), a line for each part, with a checksum."),
         ("data/scenes, data/cases", "The scenes and weight spaces that come with the program.")]
ENVIRONMENT = [("CINCH_TARGET", "Forces the instruction set of the kernels; results are the same."),
               ("CINCH_SHARDS, SLURM_ARRAY_TASK_ID", "What --shard slurm reads."),
               ("TERM", "With dumb no line is drawn over another.")]

COMPLETION = """# SPDX-License-Identifier: GPL-3.0-or-later
# bash completion for cinch; made from its --help
_cinch()
{
    local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]} words= names=
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ]; then
        COMPREPLY=($(compgen -W "@COMMANDS@ --help --version" -- "$word"))
        return
    fi
    case ${COMP_WORDS[COMP_CWORD-1]} in
@VALUES@    esac
    case $command in
@CASES@    esac
    case $word in
    -*) COMPREPLY=($(compgen -W "$words" -- "$word")) ;;
    *) COMPREPLY=($(compgen -W "$names" -- "$word") $(compgen -f -- "$word")) ;;
    esac
}
complete -o bashdefault -o default -F _cinch cinch
"""


def values_of(description):
    """The names that a description lists, as "aabb or obb" or "of convex, sphere, eq12"; none where it lists none."""
    text = re.sub(r" *(\[[^]]*\]|\([^)]*\))", "", description.split(": ", 1)[-1])
    lists = re.findall(r"[a-z0-9+-]+(?:, [a-z0-9+-]+)*(?:,? (?:or|and) [a-z0-9+-]+)?", text)
    longest = max(lists, key=lambda words: len(re.split(", | or | and ", words)), default="")
    names = [name for name in re.split(r",? (?:or|and) |, ", longest) if name and name not in ("or", "and")]
    return names if len(names) > 1 and not {"of", "to"} & set(names) else []


def completion(program):
    commands = entries_of(parsed(help_of(program))[2], {"Subcommands"})
    cases, values = "", {}
    for command, _ in commands:
        sections = parsed(help_of(program, command))[2]
        options = []
        for entry, description in entries_of(sections, {"Options"}):
            options += re.findall(r"--[a-z0-9-]+", entry.split(" Excludes")[0])
            if re.search(r" (NAME|K|KIND|SHAPE)\b", entry):
                values.setdefault(options[-1], values_of(description))
        names = [name for _, description in entries_of(sections, {"Positionals"})
                 for listed in re.findall(r"\(([^)]*)\)", description)
                 for name in listed.split(", ") if re.fullmatch(r"[a-z][a-z0-9-]*", name)]
        cases += f"    {command}) words=\"{' '.join(options)}\" names=\"{' '.join(names)}\" ;;\n"
    known = "".join(f"    {option}) COMPREPLY=($(compgen -W \"{' '.join(names)}\" -- \"$word\")); return ;;\n"
                    for option, names in values.items() if names)
    return (COMPLETION.replace("@COMMANDS@", " ".join(["help"] + [name for name, _ in commands]))
            .replace("@CASES@", cases).replace("@VALUES@", known))


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "cinch.1").write_text(manual(program))
    (folder / "cinch.bash").write_text(completion(program))


if __name__ == "__main__":
    main()
