#!/usr/bin/env python3
"""Manual pages and shell completions, made from what the program says of itself.

usage: from_help.py FRESHET OUT     FRESHET: the executable; OUT: a folder, that gets man1/, bash/, zsh/ and fish/
"""
import gzip
import pathlib
import re
import shutil
import subprocess
import sys


COLUMN = 30  # where texts begin in the help


class Command:
    """A command as its help describes it."""

    def __init__(self, program, path):
        self.path = path
        text = help_of(program, path, "--help")
        if "--help-all" in text:
            text = help_of(program, path, "--help-all")
        lines = text.splitlines()
        usage = next(i for i, line in enumerate(lines) if line.startswith("Usage: "))
        self.what = " ".join(line.strip() for line in lines[:usage])
        self.usage = lines[usage].removeprefix("Usage: ")
        self.sections = []  # (title, [(head, text)])
        self.footer = []
        blank = False
        for line, following in zip(lines[usage + 1:], lines[usage + 2:] + [""]):
            title = re.fullmatch(r"(\S.*):", line)
            if title and blank and not self.footer and title[1] != "A first animation":
                self.sections.append((title[1], []))
            elif line and not line.startswith(" ") or self.footer:
                self.footer.append(line)
            elif re.match(r" {2}\S", line) and self.sections:
                # Else the text begins in the next line; a list of other options may have a space there, too.
                narrow = line[COLUMN - 1:COLUMN] == " " and not (
                    re.search("Needs:|Excludes:", line[:COLUMN]) and following.startswith(" " * COLUMN))
                entry = [line[2:COLUMN].strip(), line[COLUMN:]] if narrow else [line.strip(), ""]
                self.sections[-1][1].append(entry)
            elif line.strip():
                entry = self.sections[-1][1][-1]
                entry[1] = (entry[1] + " " + line.strip()).strip()
            blank = not line.strip()
        self.below = [Command(program, path + [name]) for name, _ in self.entries("Subcommands")]

    def entries(self, title):
        return [entry for name, entries in self.sections if name == title for entry in entries]

    def options(self):
        """(names, values or None where it takes none, what) of each."""
        for title, entries in self.sections:
            for head, text in entries:
                if title in ("Positionals", "Subcommands") or not head.startswith("-"):
                    continue
                names, _, kind = head.partition(" ")
                kind = re.sub(r"\s*(Excludes|Needs):.*", "", kind)
                choices = re.search(r"\{([^}]*)\}", kind)
                values = None if not kind else choices[1].split(",") if choices else []
                yield names.split(","), values, text

    def all(self):
        yield self
        for command in self.below:
            yield from command.all()


def help_of(program, path, option):
    return subprocess.run([program, *path, option], check=True, capture_output=True, text=True).stdout


def roff(text):
    return re.sub(r"(?m)^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"))


def manual(command, version):
    name = "-".join(["freshet", *command.path])
    out = [f'.TH {name.upper()} 1 "" "freshet {version}" "User Commands"', ".SH NAME",
           roff(f"{name} - {command.what.rstrip('.')}"), ".SH SYNOPSIS", ".B " + roff(command.usage)]
    for title, entries in command.sections:
        title = {"Positionals": "Arguments", "Subcommands": "Commands"}.get(title, title)
        out.append(f'.SH "{roff(title.upper())}"')
        for head, text in entries:
            page = "-".join([name, head])
            text = f"{text} See {page}(1)." if title == "Commands" else text
            out += [".TP", ".B " + roff(head), roff(text or "-")]
    if not command.path:
        out += [".SH EXAMPLES AND FILES", ".nf", roff("\n".join(command.footer)), ".fi"]
    out += [".SH SEE ALSO", "/usr/share/doc/freshet/manual.md" if not command.path else ".BR freshet (1)"]
    return "\n".join(out) + "\n"


def words(command):
    return [below.path[-1] for below in command.below] + [n for names, _, _ in command.options() for n in names]


def tail_case(command):
    """Of shells' case: the words so far that are commands."""
    return " ".join(command.path)


def bash(root):
    out = ["# freshet: bash completion, made from its help", "_freshet() {",
           "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} path= i next",
           "  for ((i = 1; i < COMP_CWORD; ++i)); do",
           "    next=\"${path:+$path }${COMP_WORDS[i]}\"",
           "    case $next in",
           "      " + "|".join(f'"{tail_case(c)}"' for c in root.all() if c.path) + ") path=$next ;;",
           "    esac", "  done", '  case "$path $before" in']
    for command in root.all():
        for names, values, _ in command.options():
            if values:
                for name in names:
                    out.append(f'    "{tail_case(command)} {name}") COMPREPLY=($(compgen -W "{" ".join(values)}" -- "$word")); return ;;')
    out += ["  esac", '  case "$path" in']
    for command in root.all():
        out.append(f'    "{tail_case(command)}") COMPREPLY=($(compgen -W "{" ".join(words(command))}" -- "$word")) ;;')
    out += ["  esac", "}", "complete -o default -F _freshet freshet"]
    return "\n".join(out) + "\n"


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh(root):
    out = ["#compdef freshet", "# made from its help", "local path_so_far= next i", "local -a known",
           "for ((i = 2; i < CURRENT; ++i)); do",
           "  next=\"${path_so_far:+$path_so_far }${words[i]}\"",
           "  case $next in",
           "    " + "|".join(f'"{tail_case(c)}"' for c in root.all() if c.path) + ") path_so_far=$next ;;",
           "  esac", "done", 'case "$path_so_far ${words[CURRENT-1]}" in']
    for command in root.all():
        for names, values, _ in command.options():
            if values:
                for name in names:
                    out.append(f'  "{tail_case(command)} {name}") compadd -- {" ".join(values)}; return ;;')
    out += ["esac", 'case "$path_so_far" in']
    for command in root.all():
        known = [below.path[-1] + ":" + below.what.replace(":", "\\:") for below in command.below]
        known += [n + ":" + what.replace(":", "\\:") for names, _, what in command.options() for n in names]
        out.append(f'  "{tail_case(command)}") known=({" ".join(quoted(one) for one in known)}) ;;')
    out += ["esac", "_describe freshet known", "_files"]
    return "\n".join(out) + "\n"


def fish(root):
    out = ["# freshet: fish completion, made from its help",
           "function __freshet_at",
           "  # Whether the commands so far are these.",
           "  set -l so_far",
           "  for word in (commandline -opc)[2..-1]",
           "    set -l next (string join -- ' ' $so_far $word)",
           "    if contains -- $next " + " ".join(quoted(tail_case(c)) for c in root.all() if c.path),
           "      set so_far $so_far $word",
           "    end", "  end",
           '  test "$so_far" = "$argv"', "end"]
    for command in root.all():
        at = quoted(f"__freshet_at {tail_case(command)}".strip())
        for below in command.below:
            out.append(f"complete -c freshet -f -n {at} -a {below.path[-1]} -d {quoted(below.what)}")
        for names, values, what in command.options():
            flags = " ".join(("-l " + n[2:]) if n.startswith("--") else ("-s " + n[1:]) for n in names)
            takes = "" if values is None else " -r" if not values else " -x -a " + quoted(" ".join(values))
            out.append(f"complete -c freshet -n {at} {flags}{takes} -d {quoted(what)}")
    return "\n".join(out) + "\n"


def main():
    program, out = sys.argv[1], pathlib.Path(sys.argv[2])
    version = help_of(program, [], "--version").split()[1]
    root = Command(program, [])
    shutil.rmtree(out, ignore_errors=True)
    for folder in ("man1", "bash", "zsh", "fish"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    for command in root.all():
        name = "-".join(["freshet", *command.path])
        page = gzip.compress(manual(command, version).encode(), mtime=0)
        (out / "man1" / f"{name}.1.gz").write_bytes(page)
    (out / "bash" / "freshet").write_text(bash(root))
    (out / "zsh" / "_freshet").write_text(zsh(root))
    (out / "fish" / "freshet.fish").write_text(fish(root))


if __name__ == "__main__":
    main()
