"""A Dask cluster that grades: the same jobs, whose submissions travel as bytes. Pure: no ROS."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

CONNECT_TIMEOUT = 20.0
RETRIES = 3  # of a job whose worker has ended


@contextmanager
def executor(address: str) -> Iterator[Executor]:
    """An executor whose jobs run on the workers of the scheduler at this address. OSError if it cannot be reached.

    Each worker has the course set up as here, in the same version. A worker grades one notebook a thread.
    """
    from distributed import Client

    try:
        client = Client(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        raise OSError(f"no scheduler of Dask answers at {address}: {error}") from None
    with client, client.get_executor(retries=RETRIES, pure=False) as made:
        yield made
