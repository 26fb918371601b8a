"""
Tries: name files outside of the package on the magic lines.

Stopped by: names are letters and digits; each answer has to be the file that the release says
Deserves: 10
Flag: expected the first line
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    for name, line in (
        ('temperature_publisher', '%%node ../../../autograder/exams/hidden/temperature_publisher'),
        ('temperature_subscriber', '%%node /tmp/an-attack-of-the-corpus-ran'),
        ('temperature_msg', '%%rosmsg ../../etc/cron.d/x'),
        ('package_xml', '%%rospkg ../package.xml'),
        ('cmakelists', '%%rospkg CMakeLists.txt\x00.py'),
    ):
        cell(solved, name)['source'] = f'{line}\nprint(1)\n'
    return solved
