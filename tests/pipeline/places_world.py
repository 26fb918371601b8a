"""A small exam and small programs, to run on this machine and on workers."""

from autograder.exam.exam import Exam, Failed, Run
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance

TALKER = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('talker')
publisher = node.create_publisher(String, '/said', 10)
node.create_timer(1.0, lambda: publisher.publish(String(data={word!r})))
rclpy.spin(node)
"""


def exam_of_a_talker() -> Exam:
    """Return an exam of three virtual seconds."""
    scenario = Scenario(
        file='talker.py',
        watch={'/said': 'std_msgs/msg/String'},
        steps=(Advance(3.0),),
    )
    exam = Exam(
        'talker',
        title='Talker',
        assignment='01',
        part=1,
        cells=('talker',),
        requires=('talker.py',),
        scenario=scenario,
    )

    @exam.check(points=1)
    def talks(run: Run) -> None:
        """Your node says the right word."""
        said = [event['data']['data'] for event in run.recording.messages('/said')]
        if set(said) != {'right'}:
            raise Failed(expected='right', observed=', '.join(said))

    @exam.check(points=1)
    def stays(run: Run) -> None:
        """Your node runs to the end."""
        if run.recording.end_reason != 'complete':
            raise Failed(expected='a whole run', observed=run.recording.end_reason)

    return exam


def class_of_talkers() -> list[dict[str, str]]:
    """Return the files of three students: correct, wrong, ended by an exception."""
    files = [{'talker.py': TALKER.format(word=word)} for word in ('right', 'wrong')]
    return [*files, {'talker.py': 'raise ValueError("oops")\n'}]


def stable_facts(result) -> dict:
    """Return a result without the parts that depend on the time and place of the run."""
    data = result.to_json()
    for name in ('timing', 'recording'):
        data.pop(name)
    return data
