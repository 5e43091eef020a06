"""The build of the messages: what one generator has parsed, the next one reads."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.packaging.project import ROOT

LAUNCHER = ROOT / "sailenv_msgs" / "parse_once.py"
GENERATOR = """
import sys
from rosidl_parser import parser
if "other" in sys.argv:
    def refuse(text):
        raise SystemExit("parsed again")
    parser.get_ast_from_idl_string = refuse
from rosidl_parser.parser import parse_idl_file
from rosidl_parser.definition import IdlLocator, Message
content = parse_idl_file(IdlLocator(sys.argv[-2], sys.argv[-1])).content
(message,) = content.get_elements_of_type(Message)
print([member.name for member in message.structure.members])
"""
IDL = "module a_msgs { module msg { struct One { double here; string there; }; }; };"


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a command as the build does."""
    command = [sys.executable, str(LAUNCHER), str(folder / "parsed"), *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_an_interface_is_parsed_once(tmp_path: Path) -> None:
    """A second generator needs no parser; a changed interface is parsed again."""
    (tmp_path / "generator").write_text(GENERATOR)
    (tmp_path / "One.idl").write_text(IDL)
    words = [sys.executable, str(tmp_path / "generator"), "--generator-arguments-file"]
    here = [str(tmp_path), "One.idl"]
    for more in ([], ["other"]):
        done = run(tmp_path, *words, *more, *here)
        assert done.stdout == "['here', 'there']\n", done.stderr
    (tmp_path / "One.idl").write_text(IDL.replace("here", "where", 1))
    assert "parsed again" in run(tmp_path, *words, "other", *here).stderr
    assert run(tmp_path, *words, *here).stdout == "['where', 'there']\n"


def test_other_commands_run_as_they_are(tmp_path: Path) -> None:
    """With their own status and output."""
    done = run(tmp_path, "bash", "-c", "echo said; exit 3")
    assert (done.returncode, done.stdout) == (3, "said\n")
    assert not (tmp_path / "parsed").exists()
