# See local_setup.sh.
COLCON_CURRENT_PREFIX="${COLCON_CURRENT_PREFIX:-$(builtin cd -q "$(dirname "${(%):-%N}")" > /dev/null && pwd)}"
. "$COLCON_CURRENT_PREFIX/local_setup.sh"
unset COLCON_CURRENT_PREFIX
