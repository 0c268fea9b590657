"""Each test process gets a ROS domain of its own, on localhost, with the course's discovery profile."""

from tests.domains import use_own_domain

use_own_domain()
