"""Read a bag: an MCAP file, or the folder that ``ros2 bag record`` has written."""

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
import os
from pathlib import Path
from typing import NamedTuple

from mcap.reader import SeekingReader
from mcap.summary import Summary
import yaml

from roslab.bags.bag import Bag, BagTopic, read_profiles
from roslab.errors import RoslabError

_MAGIC = b'\x89MCAP0\r\n'
"""The first and the last bytes of every file."""


class BagError(RoslabError, RuntimeError):
    """Raised for an unusable bag; the ``ros2`` command prints a RuntimeError as one line."""


class BagMessage(NamedTuple):
    """A recorded message, with the time of its arrival [ns since 1970]."""

    topic: str
    received_ns: int
    data: bytes


def open_bag(path: Path) -> Bag:
    """Return the summary of a bag; BagError if it is missing, damaged or not of ROS 2."""
    files = _files_in(path) if path.is_dir() else (path,)
    topics: dict[str, BagTopic] = {}
    counts: Counter[str] = Counter()
    times: list[int] = []
    distro = ''
    for file in files:
        with _reading(file) as reader:
            summary = reader.get_summary()
            if summary is None or summary.statistics is None:
                raise _incomplete(file)
            for topic in _topics_of(file, summary):
                topics.setdefault(topic.name, topic)
                counts[topic.name] += topic.count
            about = summary.statistics
            if about.message_count:
                times += [about.message_start_time, about.message_end_time]
            distro = distro or _distro(reader)
    named = (replace(one, count=counts[name]) for name, one in sorted(topics.items()))
    first, last = (min(times), max(times)) if times else (0, 0)
    return Bag(path, files, tuple(named), first, last, distro)


def messages_of(bag: Bag) -> Iterator[BagMessage]:
    """Yield the messages in the order of their arrival; BagError if part of a file is damaged."""
    for file in bag.files:
        with _reading(file) as reader:
            for _, channel, message in reader.iter_messages():
                yield BagMessage(channel.topic, message.log_time, message.data)


def _files_in(folder: Path) -> tuple[Path, ...]:
    about = folder / 'metadata.yaml'
    names = [file.name for file in sorted(folder.glob('*.mcap'))]
    if about.is_file():
        try:
            metadata = yaml.safe_load(about.read_text(encoding='utf-8'))
            names = list(metadata['rosbag2_bagfile_information']['relative_file_paths'])
        except (yaml.YAMLError, UnicodeDecodeError, KeyError, TypeError):
            raise BagError(f'{about}: this is not the metadata of a bag.') from None
    if not names:
        raise BagError(
            f'{folder}: this folder has no .mcap file. Try: pass a folder from ros2 bag record'
        )
    return tuple(folder / name for name in names)


@contextmanager
def _reading(file: Path) -> Iterator[SeekingReader]:
    """Open a file, and raise a BagError for any problem with it."""
    if not file.exists():
        raise BagError(f'{file}: there is no such file. Try: pass the same path as to record()')
    try:
        with file.open('rb') as stream:
            if stream.read(len(_MAGIC)) != _MAGIC:
                raise _foreign(file)
            stream.seek(-len(_MAGIC), os.SEEK_END)
            if stream.tell() == 0 or stream.read() != _MAGIC:
                raise _incomplete(file)
            stream.seek(0)
            yield SeekingReader(stream, validate_crcs=True)
    except (GeneratorExit, RoslabError):
        raise
    except OSError as error:
        raise BagError(f'{file}: cannot be read: {error.strerror or error}.') from None
    except Exception as error:  # mcap raises exceptions of many unrelated classes
        raise BagError(
            f'{file}: this file is damaged ({type(error).__name__}). Try: record it again'
        ) from None


def _foreign(file: Path) -> BagError:
    if file.suffix == '.db3':
        return BagError(
            f'{file}: this bag is in SQLite format. Try: convert it to MCAP with '
            'ros2 bag convert in a full installation of ROS 2'
        )
    return BagError(f'{file}: this is not an MCAP file. Try: pass a file that record() wrote')


def _incomplete(file: Path) -> BagError:
    return BagError(
        f'{file}: the end of this file is missing, so it was not written or copied completely. '
        'Try: copy or record it again'
    )


def _topics_of(file: Path, summary: Summary) -> Iterator[BagTopic]:
    counts = summary.statistics.channel_message_counts if summary.statistics else {}
    for channel in summary.channels.values():
        schema = summary.schemas.get(channel.schema_id)
        if channel.message_encoding != 'cdr' or schema is None or schema.name.count('/') != 2:
            raise BagError(
                f'{file}: {channel.topic} contains {channel.message_encoding or "unknown"} data, '
                'not ROS 2 messages. Try: pass a file that record() or ros2 bag has written'
            )
        about = channel.metadata
        yield BagTopic(
            channel.topic,
            schema.name,
            read_profiles(about.get('offered_qos_profiles', '')),
            about.get('topic_type_hash', ''),
            counts.get(channel.id, 0),
        )


def _distro(reader: SeekingReader) -> str:
    for record in reader.iter_metadata():
        if record.name == 'rosbag2':
            metadata = yaml.safe_load(record.metadata.get('serialized_metadata', '')) or {}
            found = record.metadata.get('ROS_DISTRO') or metadata.get('ros_distro')
            if found:
                return str(found)
    return ''
