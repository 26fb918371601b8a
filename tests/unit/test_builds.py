"""Explanations of failed builds, tested on the output of ROS 2 Jazzy's build tools."""

import pytest

from autograder.judging.causes.builds import (
    diagnose,
    MISSING_AMENT_PACKAGE,
    NO_MESSAGES,
    texts_of,
    why_no_messages,
)
from autograder.judging.causes.text_table import rows_of

ADAPTER = """
CMake Error at /opt/ros/share/rosidl_adapter/cmake/rosidl_adapt_interfaces.cmake:57 (message):
  execute_process(/usr/bin/python3 -m rosidl_adapter
  --package-name temp_monitor_pkg --arguments-file
  /home/me/build/temp_monitor_pkg/rosidl_adapter__arguments__temp_monitor_pkg.json)
  returned error code 1:

"""
GENERATE = """
CMake Error at /opt/ros/share/rosidl_cmake/cmake/rosidl_generate_interfaces.cmake:223 (message):
"""
MANIFEST = "catkin_pkg.package.InvalidPackage: Error(s) in package '/home/me/package.xml':\n"

PRINTED = {
    'xml_not_well_formed': MANIFEST
    + 'The manifest contains invalid XML:\nmismatched tag: line 7, column 23\n'
    + 'CMake Error at somewhere',
    'wrong_build_type': 'WARNING:colcon.colcon_ros.task.ament_python.build:Package has no marker',
    'manifest_rule': MANIFEST
    + 'Package version "0.1" does not follow version conventions\nCMake Error at x',
    'missing_group': GENERATE
    + '  Packages installing interfaces must include\n'
    + "  '<member_of_group>rosidl_interface_packages</member_of_group>' in their\n  package.xml\n",
    'name_mismatch': "ament_package_xml() package name 'temp_monitor_pkg' in '/package.xml' does\n"
    "  not match current PROJECT_NAME 'temp_monitor'.  You must call project()\n",
    'comma': GENERATE
    + '  The target name "temp_monitor_pkg," is reserved or not valid for certain\n'
    + '  CMake features, such as generator expressions\n',
    'package_name': ADAPTER
    + "  rosidl_adapter.parser.InvalidResourceName: 'temp-monitor-pkg' is an invalid\n"
    + "  package name.  It should have the pattern '^(?!.*__)'\n",
    'missing_find_package_generators': 'CMake Error at CMakeLists.txt:5 '
    '(rosidl_generate_interfaces):\n  Unknown CMake command "rosidl_generate_interfaces".\n',
    'missing_find_package_ament': 'CMake Error at CMakeLists.txt:7 (ament_package):\n'
    '  Unknown CMake command "ament_package".\n',
    'unknown_command': 'CMake Error at CMakeLists.txt:6 (rosidl_generate_interface):\n'
    '  Unknown CMake command "rosidl_generate_interface".\n',
    'missing_find_package': GENERATE
    + "  rosidl_generate_interfaces() the passed dependency 'builtin_interfaces' has\n"
    + '  not been found before using find_package()\n',
    'package_not_found': 'CMake Error at CMakeLists.txt:4 (find_package):\n'
    '  By not providing "Findbuiltin_interface.cmake" in CMAKE_MODULE_PATH this\n',
    'dependencies_keyword': GENERATE
    + "  rosidl_generate_interfaces() the passed file 'builtin_interfaces' doesn't\n"
    + '  exist relative to the CMAKE_CURRENT_SOURCE_DIR\n',
    'file_not_listed': GENERATE
    + "  rosidl_generate_interfaces() the passed file 'msg/temperature.msg' doesn't\n"
    + '  exist relative to the CMAKE_CURRENT_SOURCE_DIR\n',
    'target_name': '[26/26] Linking C shared module temp_monitor_pkg.so\n-- Installing: '
    '/ws/install/share/temp_monitor_pkg/cmake/export_temp__rosidl_generator_cExport.cmake\n',
    'no_file_listed': GENERATE
    + '  rosidl_generate_interfaces() called without any interface files\n',
    'ament_package_first': GENERATE
    + '  rosidl_generate_interfaces() must be called before ament_package()\n',
    'cmake_syntax': 'CMake Error at CMakeLists.txt:6:\n'
    '  Parse error.  Function missing ending ")".  End of file reached.\n',
    'missing_minimum_required': 'CMake Error in CMakeLists.txt:\n'
    '  No cmake_minimum_required command is present.  A line of code such as\n',
    'python_install_twice': 'CMake Error at /opt/ros/ament_python_install_package.cmake:66 '
    '(message):\n  ament_python_install_package() the Python package folder\n',
    'dotted_type': ADAPTER
    + "  Error processing 'builtin_interfaces.msg.Time timestamp' of\n"
    + "  'temp_monitor_pkg/Temperature': ''builtin_interfaces.msg.Time' is an\n"
    + "  invalid message name.  It should have the pattern '^[A-Z][A-Za-z0-9]*$''\n",
    'field_order': ADAPTER
    + "  Error processing 'unit: string' of 'temp_monitor_pkg/Temperature': ''unit:'\n"
    + '  is an invalid message name.  It should have the pattern\n',
    'unknown_type': ADAPTER
    + "  Error processing 'float temperature_value' of\n"
    + "  'temp_monitor_pkg/Temperature': ''float' is an invalid message name.  It\n",
    'bad_field_name': ADAPTER
    + "  Error processing 'float64 temperatureValue' of\n"
    + "  'temp_monitor_pkg/Temperature': ''temperatureValue' is an invalid field\n  name.\n",
    'msg_in_type': ADAPTER
    + "  Error processing 'builtin_interfaces/msg/Time timestamp' of\n"
    + "  'temp_monitor_pkg/Temperature': 'builtin_interfaces/msg/Time'\n",
    'incomplete_field': ADAPTER
    + '  Error with: temp_monitor_pkg Temperature unit\n\n  Traceback (most recent call last):\n'
    + '  rosidl_adapter.parser.InvalidFieldDefinition: unit\n',
    'indented_line': ADAPTER + "  TypeError: the constant type '' must be a primitive type\n",
    'duplicate_field': ADAPTER
    + '  ValueError: the fields iterable contains duplicate names: temperature_value\n',
    'missing_dependencies': "KeyError: 'builtin_interfaces'\ngmake[2]: *** [CMakeFiles/"
    'temp_monitor_pkg__rosidl_generator_type_description.dir/build.make:75: x.json] Error 1\n',
    'type_without_package': 'FileNotFoundError: [Errno 2] No such file or directory: '
    "'/home/me/build/rosidl_generator_type_description/temp_monitor_pkg/msg/Time.json'\n",
    'reserved_word': '/home/me/detail/temperature__struct.h:33:33: error: expected identifier '
    'before ‘;’ token\n   33 |   rosidl_runtime_c__String class;\n      |          ^\n',
    'nothing_to_build': "ignoring unknown package 'temp_monitor_pkg' in --packages-select\n",
}


PYTHON_PRINTED = {
    'not_a_python_package': 'CMake Error: The source directory "/home/me/pkg" does not appear to '
    'contain CMakeLists.txt.\n',
    'setup_py': '  File "/opt/setuptools/core.py", line 268, in run_setup\n    exec(code, g)\n'
    '  File "<string>", line 7\n    version="0"\n            ^^^\n'
    'SyntaxError: invalid syntax. Perhaps you forgot a comma?\nTraceback (most recent call last):',
    'not_a_file': "error: can't copy 'config/a.yaml': doesn't exist or not a regular file\n",
}


@pytest.mark.parametrize('cause', [row.cause_id for row in rows_of('of_builds.txt')])
def test_every_mistake_of_the_table_is_recognised(cause):
    diagnosis = diagnose(PRINTED[cause], {})

    assert diagnosis.cause_id == cause
    for text in (diagnosis.text, diagnosis.try_this):
        assert text
        assert '\n' not in text
        assert '{' not in text.replace('${PROJECT_NAME}', '')


@pytest.mark.parametrize('cause', [row.cause_id for row in rows_of('of_python_builds.txt')])
def test_every_mistake_of_a_python_package_is_recognised(cause):
    printed = 'WARNING:colcon.colcon_ros.task.ament_python\n' + PYTHON_PRINTED[cause]

    assert diagnose(printed, {'setup.py': ''}).cause_id == cause
    assert diagnose(printed, {}).cause_id == 'wrong_build_type'


def test_line_of_setup_py_is_named():
    found = diagnose(PYTHON_PRINTED['setup_py'], {'setup.py': ''})

    assert found.text == 'setup.py, line 7: Python stops in setup.py: SyntaxError: invalid syntax.'


def test_missing_message_package_of_others_is_named_with_the_file_to_edit():
    """A package that is not installed is named, because its name may be misspelt."""
    diagnosis = diagnose(PRINTED['package_not_found'].replace('builtin_interface', 'toy_msgs'), {})

    assert diagnosis.cause_id == 'package_not_found'
    assert diagnosis.text == "CMakeLists.txt: There is no package 'toy_msgs'."
    assert 'environment/messages.txt' in diagnosis.try_this


@pytest.mark.parametrize(
    ('printed', 'files', 'text'),
    [
        (
            'unknown_type',
            {'msg/Temperature.msg': '# one\nstring unit\nfloat   temperature_value  # wrong\n'},
            'msg/Temperature.msg, line 3: ',
        ),
        # In other files than CMakeLists.txt, a hash begins no comment.
        (
            'unknown_type',
            {'msg/Temperature.msg': 'string unit\n# float temperature_value\n'},
            'msg/Temperature.msg, line 2: ',
        ),
        # The lesson's comments name the commands that students write below them.
        (
            'target_name',
            {
                'CMakeLists.txt': '# rosidl_generate_interfaces(...)\n\n'
                'rosidl_generate_interfaces(temp "a.msg")\n'
            },
            'CMakeLists.txt, line 3: ',
        ),
        ('cmake_syntax', {}, 'CMakeLists.txt, line 6: '),
    ],
)
def test_the_line_of_the_mistake_is_named(printed, files, text, tmp_path):
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(content)

    assert diagnose(PRINTED[printed], texts_of(tmp_path)).text.startswith(text)


def test_texts_name_the_names_of_the_student():
    wrong_type = diagnose(PRINTED['unknown_type'], {})
    target = diagnose(PRINTED['target_name'], {})

    assert "'float'" in wrong_type.text
    assert 'float64' in wrong_type.try_this
    assert target.text.endswith('is temp, but the project is called temp_monitor_pkg.')


def test_libraries_named_after_the_package_have_the_right_target():
    output = PRINTED['target_name'].replace('export_temp__', 'export_temp_monitor_pkg__')

    assert why_no_messages(output, {}) == NO_MESSAGES


def test_cause_of_an_unregistered_package_names_its_file():
    """No tool reports this mistake, so no output shows it."""
    assert MISSING_AMENT_PACKAGE.cause_id == 'missing_ament_package'
    assert MISSING_AMENT_PACKAGE.text.startswith('CMakeLists.txt: ')


def test_unknown_failure_shows_its_first_error():
    output = 'all is well\nfoo.c:1:2: error: no such thing\nbar.c:3:4: error: another\n'
    diagnosis = diagnose(output, {})

    assert diagnosis.cause_id == ''
    assert diagnosis.text == 'foo.c:1:2: error: no such thing'


def test_unknown_failure_of_a_generator_shows_the_exception():
    output = ADAPTER + '  File "parser.py", line 5, in parse\n\n  LookupError: no such thing\n'

    assert diagnose(output, {}).text == 'LookupError: no such thing'


def test_words_of_cmake_are_passed_on_whole_and_without_folders():
    said = '  ament_export_x() must be called before ament_package().  It reads\n  /opt/a/b.cmake'
    output = f'CMake Error at /opt/ros/share/x.cmake:2 (message):\n{said} {"and so on " * 30}\n\n'
    own = 'CMake Error at CMakeLists.txt:7 (include):\n  cannot find:\n\n    /opt/a/b.cmake\n'

    assert diagnose(output, {}).text == ('ament_export_x() must be called before ament_package().')
    assert diagnose(own, {}).text == 'CMakeLists.txt, line 7: cannot find: b.cmake'


def test_names_of_packages_may_be_wrong_ones():
    output = PRINTED['name_mismatch'].replace("'temp_monitor_pkg'", "'temp-monitor-pkg'")

    assert "'temp-monitor-pkg'" in diagnose(output, {}).text


def test_output_without_any_line_is_said_to_be_empty():
    assert 'nothing' in diagnose('', {}).text
