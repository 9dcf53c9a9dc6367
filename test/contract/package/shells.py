"""What bash and zsh complete with the installed files."""

import os
import pty
import re
import select
import shlex
import subprocess
import time

BASH = r"""
source "$1"
read -ra COMP_WORDS <<<"$2"
[ "${2: -1}" != ' ' ] || COMP_WORDS+=('')
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
"$3"
printf '%s\n' "${COMPREPLY[@]}"
"""


def bash_completes(file, line, folder="."):
    """What bash offers at the end of `line`. file: of the installation, named as its program."""
    # As bash splits it: --option=value is three words.
    if "=" in line:
        line = line.replace("=", " = ").rstrip()
    done = subprocess.run(["bash", "-c", BASH, "bash", file, line, "_" + file.name], cwd=folder,
                          check=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert not done.stderr, done.stderr
    return set(done.stdout.split())


class Zsh:
    """An interactive zsh with the completion in `functions`, on a terminal of ours."""

    def __init__(self, functions, path, folder="."):
        pid, self._terminal = pty.fork()
        if pid == 0:
            os.chdir(folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"],
                       {"PATH": path, "TERM": "dumb", "HOME": str(folder), "COLUMNS": "200"})
        self._pid = pid
        self._send(f"PS1='READY ' fpath=({shlex.quote(str(functions))} $fpath); unsetopt zle_bracketed_paste;"
                   "autoload -U compinit; compinit -u -D; zstyle ':completion:*' verbose no;"
                   "setopt no_always_last_prompt; LISTMAX=10000; stty -echo; print DO''NE\n")
        self._wait_for("DONE")

    def _send(self, text):
        os.write(self._terminal, text.encode())

    def _read(self, seconds):
        ready, _, _ = select.select([self._terminal], [], [], seconds)
        return os.read(self._terminal, 65536).decode(errors="replace") if ready else ""

    def _wait_for(self, mark, seconds=30):
        text, end = "", time.monotonic() + seconds
        while mark not in text:
            assert time.monotonic() < end, text
            text += self._read(1)
        return text

    def completes(self, line):
        """The line after Tab."""
        self._send(line + "\t")
        time.sleep(1)
        self._send("\x01print -r -- 'GOT<\x05>TOG'\n")  # to the begin of the line and to its end
        text = self._wait_for(">TOG\r\n")
        return re.findall(r"GOT<(.*?)>TOG\r\n", text)[-1]

    def close(self):
        os.close(self._terminal)
        os.waitpid(self._pid, 0)
