"""
Send marks by LTI 1.3 to a small platform on loopback, which checks every request.

The rules are those of 1EdTech's Security Framework 1.0 (a signed assertion for a token), Names and
Role Provisioning Services 2.0 (pages of members) and Assignment and Grade Services 2.0 (scores).
"""

from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
import json
from pathlib import Path
import threading
from urllib.parse import parse_qs

import pytest

from autograder.classroom.standing import BY_HAND
from autograder.errors import GraderError
from autograder.exports.lti import line_item, read_platform, send
from autograder.exports.marks import Mark

pytestmark = pytest.mark.lti
TOOL = 'tool-17'
MEMBERS = [
    {'user_id': 'u1', 'status': 'Active', 'lis_person_sourcedid': 'ada', 'email': 'a@uni.example'},
    {'user_id': 'u2', 'email': 'Bob@uni.example'},
    {'user_id': 'u3', 'status': 'Inactive', 'lis_person_sourcedid': 'eve'},
    {'user_id': 'u4', 'lis_person_sourcedid': 'twin'},
    {'user_id': 'u5', 'ext_user_username': 'twin'},
]
SETTINGS = """
client_id = 'tool-17'
token_url = '{url}/token'
key = 'key.pem'
members_url = '{url}/members'

[line_items]
temperature_monitor = '{url}/items/7?type_id=3'
"""


class MockPlatform(ThreadingHTTPServer):
    """A platform that knows one tool, by its public key."""

    def __init__(self, public_key: bytes) -> None:
        super().__init__(('127.0.0.1', 0), _Answers)
        self.url = f'http://127.0.0.1:{self.server_port}'
        self.public_key = public_key
        self.tokens: dict[str, str] = {}
        self.scores: list[tuple[str, dict]] = []
        self.refused = ''


class _Answers(BaseHTTPRequestHandler):
    server: MockPlatform

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers['Content-Length'])).decode()
        if self.path == '/token':
            self._give_token(parse_qs(body))
        elif self._may('scope/score') and self.path == '/items/7/scores?type_id=3':
            score = json.loads(body)
            if score['userId'] == self.server.refused:
                return self._answer(422, {'error': 'no such user'})
            self.server.scores.append((self.headers['Content-Type'], score))
            self._answer(200, {})
        else:
            self._answer(403, {'error': 'refused'})

    def do_GET(self) -> None:
        if not self._may('scope/contextmembership.readonly'):
            return self._answer(403, {'error': 'refused'})
        if 'page=Two' in self.path:
            return self._answer(200, {'members': MEMBERS[2:]})
        link = f'<{self.server.url}/members?page=Two>; rel="next"'
        self._answer(200, {'members': MEMBERS[:2]}, {'Link': link})

    def _give_token(self, form: dict[str, list[str]]) -> None:
        import jwt

        try:
            said = jwt.decode(
                form['client_assertion'][0],
                self.server.public_key,
                ['RS256'],
                audience=f'{self.server.url}/token',
            )
        except jwt.PyJWTError as error:
            return self._answer(401, {'error': str(error)})
        assert said['iss'] == said['sub'] == TOOL
        token = f'token {len(self.server.tokens)}'
        self.server.tokens[f'Bearer {token}'] = form['scope'][0]
        self._answer(200, {'access_token': token, 'token_type': 'Bearer', 'expires_in': 60})

    def _may(self, scope: str) -> bool:
        return self.server.tokens.get(self.headers['Authorization'], '').endswith(scope)

    def _answer(self, status: int, body: dict, more: dict[str, str] | None = None) -> None:
        data = json.dumps(body).encode()
        self.send_response(status)
        for name, value in {'Content-Length': str(len(data)), **(more or {})}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *_: object) -> None:
        """Print nothing."""


def _keys() -> tuple[bytes, bytes]:
    from cryptography.hazmat.primitives import serialization as form
    from cryptography.hazmat.primitives.asymmetric import rsa

    key = rsa.generate_private_key(public_exponent=65537, key_size=2048)
    private = key.private_bytes(form.Encoding.PEM, form.PrivateFormat.PKCS8, form.NoEncryption())
    public = form.PublicFormat.SubjectPublicKeyInfo
    return private, key.public_key().public_bytes(form.Encoding.PEM, public)


@pytest.fixture(scope='module')
def keys() -> tuple[bytes, bytes]:
    """Return a private and a public key."""
    return _keys()


@pytest.fixture
def platform(keys: tuple[bytes, bytes]) -> Iterator[MockPlatform]:
    """Run a platform."""
    with MockPlatform(keys[1]) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield server
        server.shutdown()
        thread.join()


@pytest.fixture
def settings(platform: MockPlatform, keys: tuple[bytes, bytes], tmp_path: Path) -> Path:
    """Write the settings and the tool's key."""
    (tmp_path / 'key.pem').write_bytes(keys[0])
    file = tmp_path / 'lti.toml'
    file.write_text(SETTINGS.format(url=platform.url), encoding='utf-8')
    return file


def _sent(settings: Path, *marks: Mark, dry_run: bool = False):
    known = read_platform(settings)
    return send(known, line_item(known, settings, '07_temperature_monitor'), marks, dry_run)


def test_each_mark_reaches_the_member_with_the_students_id(platform, settings):
    """Members are matched by login or e-mail address, and their list has two pages."""
    done = _sent(settings, Mark('ada', 6.25, 6.5), Mark('Bob@uni.example', 0.0, 6.5))

    assert [kind for kind, _ in platform.scores] == ['application/vnd.ims.lis.v1.score+json'] * 2
    scores = {score['userId']: score for _, score in platform.scores}
    assert (scores['u1']['scoreGiven'], scores['u1']['scoreMaximum']) == (6.25, 6.5)
    assert scores['u2']['scoreGiven'] == 0.0
    assert scores['u1']['gradingProgress'] == 'FullyGraded'
    assert scores['u1']['timestamp'].endswith('+00:00')
    assert (done.filled, done.left_out) == (2, [])


def test_who_has_no_mark_or_no_single_member_gets_no_score(platform, settings):
    """No zero replaces a missing mark, and an inactive member gets no score."""
    done = _sent(
        settings,
        Mark('ada', None, 6.5, BY_HAND),
        Mark('eve', 1.0, 6.5),
        Mark('twin', 2.0, 6.5),
    )

    assert platform.scores == []
    assert dict(done.left_out) == {
        'ada': BY_HAND,
        'eve': 'the platform has no such user id, login or e-mail address',
        'twin': 'members 4, 5 have this id',
    }


def test_a_dry_run_sends_nothing(platform, settings):
    """A dry run only requests the list of members."""
    assert _sent(settings, Mark('ada', 6.5, 6.5), dry_run=True).filled == 1
    assert platform.scores == []


def test_a_refusal_says_what_was_sent_before(platform, settings):
    """The same command again is safe: the platform keeps the newest score."""
    platform.refused = 'u2'
    with pytest.raises(GraderError, match=r'422.*1 had already been sent') as refused:
        _sent(settings, Mark('ada', 1.0, 6.5), Mark('Bob@uni.example', 2.0, 6.5))
    assert 'again' in refused.value.fix


def test_a_key_that_the_platform_does_not_know_is_refused(platform, settings):
    """The platform returns no token and no members, and gets no scores."""
    (settings.parent / 'key.pem').write_bytes(_keys()[0])
    with pytest.raises(GraderError, match=r'401.*0 had already been sent'):
        _sent(settings, Mark('ada', 1.0, 6.5))
    assert platform.scores == []


def test_a_platform_that_is_not_there(settings):
    text = settings.read_text(encoding='utf-8').replace('/token', ':1/token')
    settings.write_text(text, encoding='utf-8')
    with pytest.raises(GraderError, match='0 had already been sent'):
        _sent(settings, Mark('ada', 1.0, 6.5))


@pytest.mark.parametrize(
    ('old', 'new', 'said'),
    [
        ("client_id = 'tool-17'", '', 'client_id'),
        ('key.pem', 'none.pem', 'none.pem'),
        ('members_url', 'member_url', "unknown name 'member_url'"),
        ('http://127.0.0.1', 'http://uni.example', 'expected a URL with https://'),
        ('[line_items]', '[line_items', 'the settings or the key'),
    ],
)
def test_wrong_settings_are_named(settings, old, new, said):
    text = settings.read_text(encoding='utf-8').replace(old, new)
    settings.write_text(text, encoding='utf-8')
    with pytest.raises(GraderError) as refused:
        read_platform(settings)
    assert said in refused.value.what


def test_an_assignment_without_a_column(settings):
    with pytest.raises(GraderError, match='no URL for 01_node_life'):
        line_item(read_platform(settings), settings, '01_node_life')
