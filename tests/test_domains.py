"""The ROS domains of tests: each one's own, and given back."""

from __future__ import annotations

import os

from tests.domains import OF_TESTS, own_domain, reserved_domain


def test_there_are_domains_for_any_number_of_tests_one_after_another():
    before = os.environ["ROS_DOMAIN_ID"]
    for _ in range(2 * len(OF_TESTS)):
        with own_domain() as domain:
            assert os.environ["ROS_DOMAIN_ID"] == str(domain)
    assert os.environ["ROS_DOMAIN_ID"] == before


def test_two_at_once_have_two_domains():
    with own_domain() as one, reserved_domain() as other:
        assert one != other
        assert os.environ["ROS_DOMAIN_ID"] == str(one)
