"""Provide the contents of the files of a new package."""

from dataclasses import dataclass
from xml.sax.saxutils import escape


@dataclass(frozen=True)
class NewPackage:
    """
    The settings of a new package.

    :param format: format of the manifest, 2 or 3
    :param build_type: ament_cmake or ament_python
    :param node: name of the executable to create, '' for none
    """

    name: str
    format: int
    description: str
    license: str
    maintainer: str
    email: str
    build_type: str
    dependencies: tuple[str, ...]
    node: str


_MANIFEST = """\
<?xml version="1.0"?>
<?xml-model href="http://download.ros.org/schema/package_format{format}.xsd" \
schematypens="http://www.w3.org/2001/XMLSchema"?>
<package format="{format}">
  <name>{name}</name>
  <version>0.0.0</version>
  <description>{description}</description>
  <maintainer email="{email}">{maintainer}</maintainer>
  <license>{license}</license>
{needs}
  <export>
    <build_type>{build_type}</build_type>
  </export>
</package>
"""
_CMAKE = """\
cmake_minimum_required(VERSION 3.10)
project({name})

if(CMAKE_COMPILER_IS_GNUCXX OR CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options(-Wall -Wextra -Wpedantic)
endif()

# what this package needs
find_package(ament_cmake REQUIRED)
{find}
{node}if(BUILD_TESTING)
  # If the linters are installed, they check the code and the manifest.
  find_package(ament_lint_auto QUIET)
  if(ament_lint_auto_FOUND)
    ament_lint_auto_find_test_dependencies()
  endif()
endif()

ament_package()
"""
_CMAKE_NODE = """\
add_executable({node} src/{node}.cpp)
target_include_directories({node} PUBLIC
  $<BUILD_INTERFACE:${{CMAKE_CURRENT_SOURCE_DIR}}/include>
  $<INSTALL_INTERFACE:include/${{PROJECT_NAME}}>)
target_compile_features({node} PUBLIC c_std_99 cxx_std_17)
{link}install(TARGETS {node} DESTINATION lib/${{PROJECT_NAME}})

"""
_CPP = """\
#include <cstdio>

int main(int argc, char ** argv)
{{
  (void) argc;
  (void) argv;

  std::printf("hello world {name} package\\n");
  return 0;
}}
"""
_SETUP_PY = """\
from setuptools import find_packages, setup

package_name = '{name}'

setup(
    name=package_name,
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer={maintainer!r},
    maintainer_email={email!r},
    description={description!r},
    license={license!r},
    extras_require={{'test': ['pytest']}},
    entry_points={{
        'console_scripts': [{scripts}],
    }},
)
"""
_SETUP_CFG = """\
[develop]
script_dir=$base/lib/{name}
[install]
install_scripts=$base/lib/{name}
"""
_NODE_PY = """\
def main():
    print('Hi from {name}.')


if __name__ == '__main__':
    main()
"""
_LINTER_TEST = """\
import pytest

linter = pytest.importorskip('ament_{linter}.main')


@pytest.mark.linter
def test_{linter}():
    assert linter.main(argv={arguments}) == 0, 'the lines above say what to change'
"""
_LINTERS = {'copyright': "['.', 'test']", 'flake8': '[]', 'pep257': "['.', 'test']"}


def ament_cmake_files(package: NewPackage) -> dict[str, str]:
    """Return the files of a C++ package by path; the path of a folder ends in /."""
    name, node = package.name, package.node
    find = ''.join(f'find_package({one} REQUIRED)\n' for one in package.dependencies)
    hint = '# to add another: find_package(<dependency> REQUIRED)\n'
    link = ''
    if package.dependencies:
        names = '\n  '.join(package.dependencies)
        link = f'ament_target_dependencies({node}\n  {names}\n)\n\n'
    needs = ['buildtool_depend:ament_cmake', *(f'depend:{one}' for one in package.dependencies)]
    needs += ['test_depend:ament_lint_auto', 'test_depend:ament_lint_common']
    files = {
        'package.xml': _manifest(package, needs),
        f'include/{name}/': '',
        'src/': '',
        'CMakeLists.txt': _CMAKE.format(
            name=name,
            find=find or hint,
            node=_CMAKE_NODE.format(node=node, link=link) if node else '',
        ),
    }
    if node:
        files[f'src/{node}.cpp'] = _CPP.format(name=name)
    return files


def ament_python_files(package: NewPackage) -> dict[str, str]:
    """Return the files of a Python package by path."""
    name, node = package.name, package.node
    tests = [f'ament_{linter}' for linter in _LINTERS]
    needs = [f'depend:{one}' for one in package.dependencies]
    needs += [f'test_depend:{one}' for one in (*tests, 'python3-pytest')]
    scripts = f"'{node} = {name}.{node}:main'" if node else ''
    files = {
        'package.xml': _manifest(package, needs),
        'setup.py': _SETUP_PY.format(**vars(package), scripts=scripts),
        'setup.cfg': _SETUP_CFG.format(name=name),
        f'resource/{name}': '',
        f'{name}/__init__.py': '',
    }
    if node:
        files[f'{name}/{node}.py'] = _NODE_PY.format(name=name)
    for linter, arguments in _LINTERS.items():
        text = _LINTER_TEST.format(linter=linter, arguments=arguments)
        files[f'test/test_{linter}.py'] = text
    return files


def _manifest(package: NewPackage, needs: list[str]) -> str:
    groups: dict[str, list[str]] = {}
    for need in needs:
        tag, _, name = need.partition(':')
        groups.setdefault(tag, []).append(f'  <{tag}>{escape(name)}</{tag}>\n')
    facts = {
        key: escape(value, {'"': '&quot;'})
        for key, value in vars(package).items()
        if isinstance(value, str)
    }
    text = ''.join('\n' + ''.join(lines) for lines in groups.values())
    return _MANIFEST.format(**facts, format=package.format, needs=text)
