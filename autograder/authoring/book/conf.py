"""
Sphinx settings for the book.

Pages load nothing from other hosts: the theme includes its scripts, and the scripts of widgets,
which would be loaded from another host, are off.
"""

project = 'ROS 2 nodes and topics'
html_title = project
extensions = ['myst_nb']
# The notebooks already contain their outputs.
nb_execution_mode = 'off'
nb_ipywidgets_js: dict[str, dict[str, str]] = {}
nb_merge_streams = True
myst_heading_anchors = 3
myst_heading_slug_func = 'autograder.explaining.feedback_html.section_id'
language = 'en'
html_theme = 'furo'
html_static_path = ['style.css']
html_css_files = ['style.css']
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
# Shell commands in cells are not Python, so they cannot be highlighted.
suppress_warnings = ['misc.highlighting_failure']
