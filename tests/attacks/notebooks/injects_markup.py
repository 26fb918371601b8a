"""
Tries: put scripts, event handlers, pictures, links and formulas with commands into an answer
    that a person reads.

Stopped by: Markdown is cleaned with a list of allowed tags and attributes; MathJax runs in its
    safe mode
Deserves: 50
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    cell(solved, 'explain_threshold')['source'] = (
        '# <script>alert(1)</script>\n'
        '<img src=x onerror="alert(2)"> [link](javascript:alert(3)) ![p](http://192.0.2.1/p.png)\n'
        '<svg/onload=alert(4)> <iframe srcdoc="<script>alert(5)</script>"></iframe>\n'
        '<style>body{display:none}</style> <form action=x><input name=score value=40></form>\n'
        '<a href="data:text/html,<script>alert(6)</script>">x</a> <base href="http://192.0.2.1/">\n'
        '$\\href{javascript:alert(7)}{x}$ \x1b[2J\x07 </textarea></pre></script> {{ 7 * 7 }}\n'
    )
    return solved
