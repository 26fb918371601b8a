"""
Send marks to a learning platform by LTI 1.3, with Assignment and Grade Services 2.0.

PyLTI1p3 signs the requests.  The platform's list of members (Names and Role Provisioning Services
2.0) gives the user id that each score needs.  Sending a mark again replaces it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from autograder.errors import GraderError
from autograder.exports.filling import add_names, Filled, matched
from autograder.exports.marks import Mark
from autograder.layout import read_toml

INSTALL = 'Try: .venv/bin/python -m pip install --no-deps -r environment/requirements-lti.txt'
SCORE = 'https://purl.imsglobal.org/spec/lti-ags/scope/score'
IDS = ('lis_person_sourcedid', 'ext_user_username', 'email', 'user_id')
"""Fields of a platform's member that may contain the student id."""
LOOPBACK = ('localhost', '127.0.0.1', '::1')
TIMEOUT_S = 30.0


@dataclass(frozen=True)
class Platform:
    """
    A learning platform on which this grader is registered as a tool.

    :param client_id: the tool's id on the platform
    :param token_url: URL from which the tool gets access tokens
    :param key: file with the tool's private RSA key (PEM), relative to the settings
    :param members_url: URL of the course's list of members
    :param line_items: URL of the column of the platform's gradebook, by assignment
    :param audience: audience of requests for tokens, if it is not ``token_url``
    :param key_id: the ``kid`` of the key, if the platform needs it
    """

    client_id: str
    token_url: str
    key: str
    members_url: str
    line_items: Mapping[str, str] = field(default_factory=dict)
    audience: str = ''
    key_id: str = ''


def read_platform(path: Path) -> Platform:
    """
    Read the settings of a platform.

    :param path: a TOML file whose keys are the fields of :class:`Platform`
    :raises GraderError: if the file or its key cannot be read, a value is missing or wrong, or a
        URL would send marks unencrypted
    """
    fix = 'Try: write the file as docs/exports.md describes'
    try:
        found = read_toml(path)
        key = (path.parent / str(found.get('key', ''))).read_text(encoding='ascii')
    except (OSError, ValueError) as error:
        raise GraderError(f'{path}: cannot read the settings or the key: {error}.', fix) from error
    known = {one.name for one in fields(Platform)}
    if wrong := sorted(found.keys() - known):
        raise GraderError(f'{path}: unknown name {wrong[0]!r}.', fix)
    try:
        platform = Platform(**{**found, 'key': key})
    except TypeError as error:
        raise GraderError(f'{path}: {error}.', fix) from error
    for url in (platform.token_url, platform.members_url, *platform.line_items.values()):
        parts = urlsplit(str(url))
        if parts.scheme != 'https' and parts.hostname not in LOOPBACK:
            raise GraderError(f'{path}: expected a URL with https://, got {url!r}.', fix)
    return platform


def line_item(platform: Platform, where: Path, assignment: str) -> str:
    """
    Return the URL of an assignment's line item.

    The settings may leave out the number: ``topics`` for ``03_topics``.

    :raises GraderError: if the settings contain no such URL
    """
    for name in (assignment, assignment.partition('_')[2]):
        if name in platform.line_items:
            return platform.line_items[name]
    raise GraderError(
        f'{where}: there is no URL for {assignment}.', 'Try: add it to the table [line_items]'
    )


def send(platform: Platform, url: str, marks: Sequence[Mark], dry_run: bool = False) -> Filled:
    """
    Send the marks of one assignment.

    :param dry_run: find the students on the platform, but send nothing
    :returns: the number of sent marks, and the students left out, each with the reason
    :raises GraderError: if PyLTI1p3 is not installed, or the platform refuses or cannot be
        reached; the platform keeps the marks that were already sent
    """
    try:
        from pylti1p3.assignments_grades import AssignmentsGradesService
        from pylti1p3.exception import LtiServiceException
        from pylti1p3.grade import Grade
        import requests
    except ImportError as error:
        raise GraderError('PyLTI1p3 is not installed.', INSTALL) from error
    connector = _connector(platform)
    done = Filled('the platform', column=url, row='member')
    try:
        members = _members(connector, platform.members_url)
        grades = AssignmentsGradesService(connector, {'scope': [SCORE], 'lineitem': url})
        columns = 'user id, login or e-mail address'
        for row, mark in matched(_rows(members), marks, columns, done).items():
            if mark.points is None:
                done.left_out.append((mark.student, mark.status))
                continue
            if not dry_run:
                grades.put_grade(_score(Grade(), str(members[row]['user_id']), mark))
            done.filled += 1
    except (LtiServiceException, requests.RequestException, ValueError) as error:
        raise GraderError(
            f'Sending the marks failed: {error} ({done.filled} had already been sent).',
            'Try: run the same command again; it sends all marks, and these replace the old ones',
        ) from error
    return done


def _connector(platform: Platform) -> Any:
    from pylti1p3.registration import Registration
    from pylti1p3.service_connector import ServiceConnector
    import requests

    session: Any = requests.Session()
    # Without a timeout, a silent platform could block the export forever.
    session.request = partial(session.request, timeout=TIMEOUT_S)
    known = Registration().set_client_id(platform.client_id)
    known.set_auth_token_url(platform.token_url).set_tool_private_key(platform.key)
    if platform.audience:
        known.set_auth_audience(platform.audience)
    if platform.key_id:
        known.set_kid(platform.key_id)
    return ServiceConnector(known, session)


def _members(connector: Any, url: str) -> list[Mapping[str, Any]]:
    """Return the members on all pages; PyLTI1p3's own paging changes the case of URLs."""
    from pylti1p3.names_roles import NamesRolesProvisioningService
    from requests.utils import parse_header_links

    service, found = NamesRolesProvisioningService(connector, {}), []
    while url:
        page = service.get_nrps_data(url)
        found += page['body']['members']
        links = parse_header_links(page['headers'].get('Link', ''))
        url = next((one['url'] for one in links if one.get('rel') == 'next'), '')
    return found


def _rows(members: Sequence[Mapping[str, Any]]) -> dict[str, set[int]]:
    """Return the indexes of the active members with each id."""
    by_id: dict[str, set[int]] = {}
    for row, member in enumerate(members):
        if member.get('status', 'Active') == 'Active' and member.get('user_id'):
            for name in IDS:
                add_names(by_id, str(member.get(name) or ''), row)
    return by_id


def _score(grade: Any, user_id: str, mark: Mark) -> Any:
    """Fill in a score; the platform converts it to its own maximum."""
    now = datetime.now(timezone.utc).isoformat(timespec='microseconds')
    grade.set_score_given(mark.points).set_score_maximum(mark.max_points)
    grade.set_activity_progress('Completed').set_grading_progress('FullyGraded')
    return grade.set_timestamp(now).set_user_id(user_id)
