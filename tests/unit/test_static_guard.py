"""
What came from a submission is never turned into running code outside the sandbox.

Every file of the grader and of the learner's side is read as a syntax tree and searched for the
ways in which data becomes code.  The few that are meant are listed with their reason; an entry
that is no longer needed fails, too.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ('autograder', 'roslab', 'environment')
MODULES = {'pickle', 'cPickle', 'dill', 'cloudpickle', 'marshal', 'shelve', 'joblib', 'jsonpickle'}
BUILT_IN = {'eval', 'exec', 'compile', '__import__', 'execfile'}
ATTRIBUTES = {
    'system',  # os
    'popen',
    'getoutput',  # subprocess
    'getstatusoutput',
    'create_subprocess_shell',  # asyncio
    'unsafe_load',  # yaml
    'full_load',
    'unpack_archive',  # shutil
    'extractall',  # tarfile, zipfile
    'read_pickle',  # pandas
    'load_module',
    'exec_module',
    'run_path',  # runpy
    'run_module',
    'run_cell',  # IPython
    'ex',
    'render_string',
    'from_string',  # jinja2: a template made of data
}
SOURCES = ('os', 'subprocess', 'asyncio', 'yaml', 'shutil', 'runpy', 'pandas')
SAFE_LOADERS = {'SafeLoader', 'CSafeLoader', 'BaseLoader'}

ALLOWED = {
    ('autograder/exam/catalog.py', 'exec_module'): 'an exam of the course, drawn anew',
    (
        'autograder/inside/ask_check.py',
        'exec_module',
    ): "the project's own two files, in the sandbox",
    ('autograder/inside/run_node.py', 'exec'): 'runs inside the sandbox, which is its purpose',
    ('autograder/inside/run_node.py', 'compile'): 'runs inside the sandbox, which is its purpose',
    ('autograder/inside/steady_rclpy.py', 'run_path'): 'runs inside the sandbox, on purpose',
    ('roslab/magics.py', 'exec'): "a learner's own cell, in the learner's own kernel",
    ('roslab/magics.py', 'compile'): "a learner's own cell, in the learner's own kernel",
    (
        'roslab/ros2/topic_echo.py',
        'eval',
    ): 'the expression of --filter, typed on that command line',
}
"""Places that are meant: file and word, and why."""


def findings(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Yield each way of turning data into code, with its line."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for name in node.names:
                if name.name.partition('.')[0] in MODULES:
                    yield name.name, node.lineno
        elif isinstance(node, ast.ImportFrom):
            if (node.module or '').partition('.')[0] in MODULES:
                yield str(node.module), node.lineno
            if node.module in SOURCES:
                names = (one.name for one in node.names if one.name in ATTRIBUTES)
                yield from ((name, node.lineno) for name in names)
        elif isinstance(node, ast.Call):
            yield from _of_call(node)


def _of_call(node: ast.Call) -> Iterator[tuple[str, int]]:
    called = node.func
    if isinstance(called, ast.Name) and called.id in BUILT_IN:
        yield called.id, node.lineno
    if isinstance(called, ast.Attribute):
        module = called.value.id if isinstance(called.value, ast.Name) else ''
        if called.attr in ATTRIBUTES and module not in ('platform', 're'):
            yield called.attr, node.lineno
        if module == 'yaml' and called.attr in ('load', 'load_all') and not _is_safe(node):
            yield 'yaml.load', node.lineno
    for keyword in node.keywords:
        value = keyword.value
        falsy = isinstance(value, ast.Constant) and not value.value
        if keyword.arg in ('shell', 'allow_pickle') and not falsy:
            yield keyword.arg, node.lineno


def _is_safe(call: ast.Call) -> bool:
    loaders = [*call.args[1:], *(word.value for word in call.keywords if word.arg == 'Loader')]
    return any(
        getattr(loader, 'attr', getattr(loader, 'id', '')) in SAFE_LOADERS for loader in loaders
    )


def everything() -> dict[tuple[str, str], list[int]]:
    """Return all findings of the project by file and word."""
    found: dict[tuple[str, str], list[int]] = {}
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob('*.py')):
            if '_work' in path.parts:
                continue
            tree = ast.parse(path.read_text(encoding='utf-8'), str(path))
            for word, line in findings(tree):
                place = path.relative_to(ROOT).as_posix(), word
                found.setdefault(place, []).append(line)
    return found


def test_nothing_turns_data_into_code_unless_it_is_meant():
    """Every finding is on the list, with its reason."""
    surprises = {place: lines for place, lines in everything().items() if place not in ALLOWED}

    assert surprises == {}


def test_the_list_of_what_is_meant_has_no_old_entries():
    """What is not there any more needs no excuse."""
    assert set(ALLOWED) <= set(everything())


@pytest.mark.parametrize(
    'text',
    [
        'import pickle',
        'from dill import loads',
        'from os import system',
        'eval(answer)',
        'exec(compile(answer, "a", "exec"))',
        'yaml.load(text)',
        'yaml.load(text, Loader=yaml.FullLoader)',
        'yaml.unsafe_load(text)',
        'subprocess.run(f"colcon {name}", shell=True)',
        'subprocess.run(name, shell=flag)',
        'os.system(name)',
        'tarfile.open(name).extractall()',
        'numpy.load(name, allow_pickle=True)',
        'shell.run_cell(answer)',
    ],
)
def test_the_search_finds_what_it_is_for(text):
    """The guard reports each of these dangerous lines."""
    assert list(findings(ast.parse(text)))


@pytest.mark.parametrize(
    'text',
    [
        'yaml.safe_load(text)',
        'yaml.load(text, Loader=yaml.CSafeLoader)',
        'subprocess.run([name], shell=False)',
        're.compile(pattern)',
        'json.loads(text)',
        'model.evaluate(data)',
    ],
)
def test_the_search_leaves_harmless_code_alone(text):
    """No false alarm on what looks alike."""
    assert not list(findings(ast.parse(text)))
