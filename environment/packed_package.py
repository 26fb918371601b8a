"""
Store the course's ROS package in one file that does not reveal the answers of a lesson.

Lesson 07 asks students to write this package, so students' copies contain its nodes, definitions
and build rules only in ``packed.bin``.  The set-up unpacks the file, compiles the modules with the
installed Python, builds the package and removes the sources: the nodes run, and students do not
read the answer by accident.  A student can still unpack the file on purpose; ``similar`` compares
submissions with the package.
"""

import ast
import json
from pathlib import Path
import zlib

FILE = 'packed.bin'
TOPS = ('CMakeLists.txt', 'package.xml', 'msg', 'temp_monitor_pkg')
"""Files and folders to pack; the rest of the package does not answer the lesson."""


def pack(package: Path) -> bytes:
    """Return the sources of the package as one file; equal sources give equal bytes."""
    texts: dict[str, str] = {}
    for top in TOPS:
        start = package / top
        for path in [start] if start.is_file() else sorted(start.rglob('*')):
            name = path.relative_to(package).as_posix()
            if path.is_file() and '__pycache__' not in name:
                text = path.read_text(encoding='utf-8')
                texts[name] = without_words(text) if path.suffix == '.py' else text
    return zlib.compress(json.dumps(texts, sort_keys=True).encode(), 9)


def unpack(data: bytes, folder: Path) -> None:
    """Write the packed sources to a folder."""
    for name, text in json.loads(zlib.decompress(data)).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')


def without_words(text: str) -> str:
    """Return the code of a module without its docstrings and comments."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if not isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            continue
        if ast.get_docstring(node) is not None:
            node.body[:1] = [] if len(node.body) > 1 else [ast.Pass()]
    return ast.unparse(tree)
