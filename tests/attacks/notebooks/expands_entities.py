"""
Tries: fill the memory of whoever reads package.xml, with entities in entities.

Stopped by: expat limits what entities may grow to; entities from outside are not read
Deserves: 45
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    laughs = ''.join(f'<!ENTITY l{level} "{f"&l{level - 1};" * 10}">' for level in range(1, 10))
    cell(solved, 'package_xml')['source'] = (
        '%%rospkg package.xml\n<?xml version="1.0"?>\n<!DOCTYPE package [<!ENTITY l0 "laugh">'
        f'<!ENTITY file SYSTEM "file:///etc/passwd">{laughs}]>\n'
        '<package format="3"><name>temp_monitor_pkg</name><description>&l9;&file;</description>'
        '</package>\n'
    )
    return solved
