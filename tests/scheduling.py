"""How groups of tests are given to workers: a group goes on behind a test whose worker has ended in it."""

from __future__ import annotations

from xdist.scheduler import LoadGroupScheduling  # type: ignore[import-untyped]
from xdist.workermanage import WorkerController  # type: ignore[import-untyped]


class GroupScheduling(LoadGroupScheduling):  # type: ignore[misc]
    """xdist's own would run that test again, and lose a worker each time, without an end."""

    def remove_node(self, node: WorkerController) -> str | None:
        """Take the work of a worker that has ended; return the test that it ended in, if any."""
        work = self.assigned_work[node]
        lost = next((name for tests in work.values() for name, is_done in tests.items() if not is_done), None)
        for group, tests in [*work.items()]:
            if lost in tests:
                tests[lost] = True
            if all(tests.values()):
                del work[group]
        super().remove_node(node)
        return lost

    def _reschedule(self, node: WorkerController) -> None:
        """Give a worker its next group. It begins its last test when it knows that nothing comes after it."""
        super()._reschedule(node)
        if not self.workqueue and not node.shutting_down:
            node.shutdown()
