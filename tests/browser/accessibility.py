"""Find violations on a page with axe: https://github.com/dequelabs/axe-core."""

from pathlib import Path
from typing import Any

# Do not return the elements without violations: a page of code has thousands of them.
VIOLATIONS = """async ([of, ignored]) => {
    const rules = Object.fromEntries(ignored.map(rule => [rule, {enabled: false}]));
    const found = await axe.run(of, {rules, resultTypes: ['violations']});
    if (found.inapplicable.some(({id}) => id === 'color-contrast'))
        throw new Error('axe considers all text hidden');
    return found.violations.map(({id, nodes}) => [id, nodes[0].html.slice(0, 300)]);
}"""


def violations(page: Any, *ignored: str, of: str = 'html') -> list[list[str]]:
    """
    Return the rules that a page breaks, each with its first element; fail if no text is visible.

    :param page: of a context with ``bypass_csp``, because axe is a script
    :param ignored: rules that are not tested
    :param of: selector of the elements to test
    """
    import axe_playwright_python

    page.evaluate((Path(axe_playwright_python.__file__).parent / 'axe.min.js').read_text('utf-8'))
    return page.evaluate(VIOLATIONS, [of, ignored])
