"""
Explain failed transitions of lifecycle nodes.

rclpy swallows exceptions in transition callbacks: there is no log line and no traceback.  So these
functions read the code.  Like all explanations, they never affect a verdict.
"""

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.ended import why_no_method
from autograder.judging.causes.text_table import cause_of
from autograder.judging.causes.unknown_names import homes
from autograder.submission.code.acts import place_of
from autograder.submission.code.source_code import Code


def why_refused(run: Run, name: str, again: bool = False) -> Cause:
    """
    Explain a transition that ended with FAILURE or ERROR.

    :param name: name of the transition, such as ``configure``
    :param again: whether the same transition succeeded earlier
    """
    code = Code(run.files)
    if why := why_no_method(code):
        return why
    declares = place_of(code, f'declare_parameter()@def:on_{name}')
    if again and declares and not code.names & {'undeclare_parameter', 'has_parameter'}:
        return cause_of('declared_again', name=name)
    if again:
        return cause_of('refused_again', name=name)
    taken = code.parameters(f'on_{name}')
    if taken is not None and len(taken) < 2:
        return cause_of('callback_arguments', name=name, first=(*taken, 'self')[0])
    known = homes()
    missing = next((one for one in known if one in code.undefined_names), '')
    if missing:
        return cause_of('missing_import', name=missing, callback=name, home=known[missing])
    alone = [cause_of('refuses_alone', name=name)] if name == 'activate' else []
    return cause_of('refused', name=name, closer=alone)
