# See local_setup.sh.
COLCON_CURRENT_PREFIX="${COLCON_CURRENT_PREFIX:-$(builtin cd "$(dirname "${BASH_SOURCE[0]}")" > /dev/null && pwd)}"
. "$COLCON_CURRENT_PREFIX/local_setup.sh"
unset COLCON_CURRENT_PREFIX
