"""
Tries: register input and AST transformers, display hooks and patches that would change the
    checks.

Stopped by: no cell of the notebook is executed
Deserves: 0
"""

from tests.attacks.handing_in import PAYLOAD, code


def notebook(solved, blank):
    blank['cells'].insert(
        0,
        code(
            'import ast, builtins, sys\n'
            'shell = get_ipython()\n'
            'class Nothing(ast.NodeTransformer):\n'
            '    def visit_Assert(self, node):\n'
            '        return ast.Pass()\n'
            'shell.ast_transformers.append(Nothing())\n'
            'shell.input_transformers_cleanup.append(lambda lines: ["15.0"])\n'
            'sys.displayhook = print\n'
            'import autograder.judging.judge\n'
            'autograder.judging.judge.judge = lambda *anything: ()\n'
            f'open({str(PAYLOAD)!r}, "w")\n'
        ),
    )
    return blank
