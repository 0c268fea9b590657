#!/usr/bin/env bash
# Checks this machine for the course; `lab` and `test` also set it up. --help says more.
[ -n "${BASH_VERSION:-}" ] || exec bash "$0" "$@"
set -euo pipefail

usage="Usage: ./environment-check.sh [--json]            check this machine and change nothing
       ./environment-check.sh lab [ARGUMENT...]   set up what is missing, then start JupyterLab
       ./environment-check.sh test [ARGUMENT...]  set up what is missing, then test the course

lab installs what a student needs. lab --with-grading installs what \`course grade\` needs, too; otherwise that is
installed when it is first run. test installs all. What one has installed, none takes away.
The other arguments after lab go to JupyterLab, those after test to pytest: none for every kind of proof on few cases
(8 minutes), --full for more of them (20), --all for everything (100), --changed for what a change can break (two).
PYTHON=/path/to/python3.12 chooses the Python that the set-up uses."

# The installer: one version, and the hashes of its wheels for x86_64 and aarch64.
uv_version=0.13.8
uv_hashes=(
    --hash=sha256:e18a57b8b352eb7c8feb317b9f6f533c8f0ad9673fd6cf34bbe3cf1a9f6a8984
    --hash=sha256:5337c30bb893b4f9ce0ceb921ba2da0d13f649da644f40ad3bef84083bef0203
)
other_set_up_timeout=900 # seconds

level=student                      # of what the command needs: see course_kit/setup/environment/levels.py
again="./environment-check.sh lab" # what to repeat after a failure

say() {
    stop_ticker
    printf '%s\n' "$*" >&2
}

die() {
    say "environment-check: $*"
    exit 1
}

# A module of ours in a bare Python: no packages, no variables of the user's that change Python, nothing written.
bare() { "$1" -ESB -m "course_kit.setup.environment.$2" "${@:3}"; }

# ---- Which Python

python_needed="The course needs Python 3.10 to 3.14, and beside a sourced ROS 2 the one that ROS 2 is built for."
apt_python="sudo apt-get install -y python3 python3-venv python3-dev"

# $PYTHON, or every Python on PATH, the best first.
pythons() {
    if [[ -n ${PYTHON:-} ]]; then
        printf '%s\n' "$PYTHON"
    else
        type -aP python3.12 python3.13 python3.11 python3.14 python3.10 python3
    fi
}

# The same without the one in .venv, and conda's last: its libraries get in the way of those of ROS 2.
candidates() {
    local found conda=()
    while IFS= read -r found; do
        case $found in
            "$venv"/*) ;;
            "${CONDA_PREFIX:-/no conda}"/*) conda+=("$found") ;;
            *) printf '%s\n' "$found" ;;
        esac
    done < <(pythons)
    ((${#conda[@]} == 0)) || printf '%s\n' "${conda[@]}"
}

# Sets `python` to the first that set-up can use. Fails if there is none: `advice` says why, `cure` what to do, and
# `python` is the one that came closest, which can run the checks, or empty.
choose_python() {
    local candidate said status lacking=''
    python='' cure=$apt_python advice="No Python here fits${PYTHON:+ (PYTHON=$PYTHON)}. $python_needed"
    while IFS= read -r candidate; do
        status=0
        said=$(bare "$candidate" interpreter 2> /dev/null) || status=$?
        if ((status == 0)) || { ((status == 4)) && can_do_without "$said"; }; then
            python=$candidate
            return
        elif ((status == 4)) && [[ -z $lacking ]]; then
            python=$candidate lacking=$said
            advice="$python lacks what set-up needs."
            cure="sudo apt-get install -y $lacking"
        elif ((status == 3 || status == 5)) && [[ -z $lacking ]]; then
            cure=$said
            ((status == 5)) || python=${python:-$candidate}
        fi
    done < <(candidates)
    return 1
}

# uv makes environments without the venv module.
can_do_without() { [[ $1 == *-venv && $1 != *-dev* ]] && own_uv > /dev/null; }

# Prints the path of the user's uv if it is as new as ours: older ones lack options that set-up needs.
own_uv() {
    local found version
    found=$(type -P uv) && version=$("$found" --version 2> /dev/null) || return 1
    version=${version#uv } version=${version%% *}
    [[ $(printf '%s\n' "$uv_version" "$version" | sort -V | head -n 1) == "$uv_version" ]] && printf '%s\n' "$found"
}

# ---- Checking

check() {
    local python advice cure state
    export PYTHONDONTWRITEBYTECODE=1
    state=$(venv_state)
    case $state in
        ready | foreign) python=$venv/bin/python ;;
        *) choose_python || [[ -n $python ]] || no_python "$cure" "$@" ;;
    esac
    exec "$python" -ESB -m course_kit.setup.environment "$@" "$state"
}

no_python() {
    only_failure Python "none of version 3.10 or newer${PYTHON:+ (PYTHON=$PYTHON)}" "$python_needed" "$@"
}

# The report where no Python can make it: a check's name, what was found, why it matters, the cure; then the arguments.
only_failure() {
    if [[ ${5:-} == --json ]]; then
        printf '{"ok": false, "checks": [{"name": "%s", "status": "FAIL", "detail": "%s",\n' "$1" "${2//[\"\\]/}"
        printf '  "reason": "%s", "cure": "%s"}]}\n' "$3" "$4"
    else
        printf 'FAIL  %s  %s\n              why:  %s\n              cure: %s\n' "$1" "$2" "$3" "$4"
        printf '1 checks: 0 PASS, 0 WARN, 1 FAIL\n'
    fi
    exit 1
}

# ready, below, missing, unfinished, outdated, foreign or incomplete: see course_kit/setup/environment/stamp.py.
venv_state() {
    if [[ -x $venv/bin/python ]] && bare "${PYTHON:-$venv/bin/python}" stamp state "$level" 2> /dev/null; then
        return
    elif [[ -e $stamp ]]; then
        echo unfinished
    elif [[ -n $(ls -A "$venv" 2> /dev/null) ]]; then
        echo incomplete
    else
        echo missing
    fi
}

# ---- Setting up

# Afterwards $venv/bin/python has everything the course needs.
prepare() {
    case $(venv_state) in
        ready) ;;
        foreign)
            say "Using the .venv that is there. This script did not make it and leaves it as it is."
            [[ $level == student ]] || "$venv/bin/python" -m course_kit.setup.environment.additions "$level" || exit 1
            ;;
        incomplete) die "This script did not make .venv, and the course is not in it. Move it: mv .venv .venv-mine" ;;
        *) set_up ;;
    esac
}

# Makes .venv, or adds to it; with `only_add` it does nothing else.
set_up() {
    { mkdir -p build && : >> build/set-up.lock; } 2> /dev/null ||
        die "$root cannot be written, or its disk is full. Work in a copy: cp -r '$root' ~/course && cd ~/course"
    (
        wait_for_other_set_up
        case $(venv_state) in
            ready) ;;
            below) add_packages ;;
            *) [[ ${1:-} == only_add ]] || make_venv ;;
        esac
    ) 9> build/set-up.lock
}

wait_for_other_set_up() {
    type -P flock > /dev/null || return 0
    flock --nonblock 9 && return
    say "Another set-up of this course is running; waiting for it to end."
    flock --timeout "$other_set_up_timeout" 9 || die "The other set-up did not end in $other_set_up_timeout s."
}

make_venv() {
    local python advice cure digest megabytes uv='' begun=$SECONDS
    unset PYTHONPATH PYTHONHOME PIP_USER PIP_TARGET PIP_PREFIX # they would send packages elsewhere
    choose_python || die "$advice Cure: $cure"
    bare "$python" __main__ --before-set-up >&2 || exit 1
    : > "$log"
    level=$(bare "$python" stamp level "$level")
    megabytes=$(bare "$python" stamp download "$level")
    say "Setting up the course in .venv with $python. It takes about a minute, and downloads $megabytes MB the first time."
    digest=$(bare "$python" stamp digest) # of what is installed now, whatever changes meanwhile
    remove_old_venv
    { mkdir "$venv" && echo unfinished > "$stamp"; } 2>> "$log" || fail "The folder .venv could not be made."
    begin_step "Making the environment"
    create_venv
    use_settings_of_pip
    begin_step "Fetching the installer"
    find_uv
    install_packages
    stop_ticker
    finish "$digest"
    say "Set up in $((SECONDS - begun)) s."
}

# A lower level is there and stays ready until this is done.
add_packages() {
    local python=$venv/bin/python uv='' digest what="what \`course grade\` needs"
    [[ $level == grading ]] || what="what the tests need"
    unset PYTHONPATH PYTHONHOME PIP_USER PIP_TARGET PIP_PREFIX
    : > "$log"
    begin "Adding to .venv $what, which downloads $(bare "$python" stamp download "$level") MB the first time"
    digest=$(bare "$python" stamp digest)
    use_settings_of_pip
    find_uv
    install_pins || fail "${what^} could not be installed."
    stop_ticker
    finish "$digest"
}

finish() {
    { echo "$1 $level" > "$stamp.new" && mv "$stamp.new" "$stamp"; } 2>> "$log" || fail "Set-up could not be finished."
}

# ---- Steps of set-up

steps=4
step_number=0
ticker='' # the process that keeps the line of a step up to date

# Says which step begins.
begin_step() {
    ((++step_number))
    begin "[$step_number/$steps] $1"
}

# Says what begins; in a terminal that line counts its seconds.
begin() {
    stop_ticker
    if [[ -t 2 && ${TERM:-dumb} != dumb ]]; then
        tick "$1" 9>&- & # without the lock, which it could outlive
        ticker=$!
    else
        say "$1"
    fi
}

# Until it is stopped, or the script has ended: a process in the background heeds no Ctrl-C.
tick() {
    local begun=$SECONDS
    while kill -0 $$ 2> /dev/null; do
        printf '\r%s: %d s' "$1" $((SECONDS - begun)) >&2
        sleep 1
    done
}

stop_ticker() {
    [[ -n $ticker ]] || return 0
    kill "$ticker" 2> /dev/null || true
    wait "$ticker" 2> /dev/null || true
    ticker=''
    printf '\n' >&2
}

# Runs a command of set-up; what it says goes into the log, from which a failure is explained.
step() {
    { printf '\n$ %s\n' "$*" && "$@"; } >> "$log" 2>&1
}

# Ends set-up: what failed, the likeliest cause, the cure.
fail() {
    stop_ticker
    bare "$python" failure "$1" "$log" "$again" >&2 || say "environment-check: $1 See $log"
    exit 1
}

# Moved before it is removed: interrupted half-way, what is left in .venv would not be known as ours.
remove_old_venv() {
    [[ ! -e $venv && ! -L $venv ]] || mv "$venv" "build/old-venv-$$"
    rm -rf build/old-venv-*
}

create_venv() {
    local uv
    step "$python" -m venv "$venv" && return
    uv=$(own_uv) || fail "$python could not make the environment."
    step "$uv" venv --seed --allow-existing --python "$python" "$venv" || fail "Neither $python nor uv could make .venv."
}

# Package index, proxy and certificates that pip is set up for count for uv too; see installer.py.
use_settings_of_pip() {
    local setting
    while IFS= read -r setting; do
        export "${setting?}"
    done < <("$venv/bin/python" -m pip config list 2> /dev/null | bare "$venv/bin/python" installer)
}

# Sets `uv` to the one on PATH, or fetches it; leaves it empty where neither works.
find_uv() {
    local folder=build/uv-$uv_version
    uv=$(own_uv) && return
    uv=$root/$folder/bin/uv
    "$uv" --version > /dev/null 2>&1 && return
    rm -rf "$folder"
    { echo "uv==$uv_version" "${uv_hashes[@]}" > build/uv.txt; } 2>> "$log" || fail "The folder build cannot be written."
    step "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --retries 1 --no-deps \
        --only-binary :all: --require-hashes --target "$folder" -r build/uv.txt && return
    ! bare "$python" failure --of-the-network "$log" || fail "The installer uv could not be fetched."
    say "The installer uv cannot be had here. Going on with pip, which takes about two minutes."
    uv=''
}

install_packages() {
    local ros
    ros=$(bare "$venv/bin/python" checks.ros)
    [[ -z $ros ]] || say "Using the ROS 2 in $ros."
    begin_step "Installing the packages"
    install_pins || fail "The packages could not be installed."
    begin_step "Installing the course, compiling its interfaces"
    install --no-deps -e . || fail "The course itself could not be installed."
}

install_pins() {
    bare "$venv/bin/python" pins "$level" 2>> "$log" > build/requirements.txt || fail "The folder build cannot be written."
    install --require-hashes -r build/requirements.txt
}

install() {
    if [[ -n $uv ]]; then
        step "$uv" pip install --quiet --python "$venv/bin/python" "$@"
    else
        step "$venv/bin/python" -m pip install --quiet --disable-pip-version-check "$@"
    fi
}

# ---- Starting

start_lab() {
    local options=()
    given 'ip|ServerApp\.ip' "$@" || options+=(--ip=127.0.0.1)
    if ! given 'notebook-dir|ServerApp\.(root|notebook)_dir' "$@"; then
        options+=("--ServerApp.root_dir=$root/notebooks")
        given '.*\.default_url' "$@" || options+=(--LabApp.default_url=/lab/tree/0_start.ipynb)
    fi
    given 'debug|log-level|.*\.log_level' "$@" || options+=(--ServerApp.log_level=WARN --LabApp.log_level=WARN)
    ((EUID)) || options+=(--allow-root)
    bare "$venv/bin/python" checks.notebook || options+=(--no-browser)
    ("$venv/bin/python" -m course_kit.setup.environment.address $$ &) # exec keeps the process id
    exec "$venv/bin/python" "$venv/bin/jupyter-lab" "${options[@]}" "$@"
}

# Whether one of the arguments is an option of that name: JupyterLab refuses an option that comes twice.
given() {
    local argument
    for argument in "${@:2}"; do
        [[ ! $argument =~ ^--($1)(=|$) ]] || return 0
    done
    return 1
}

run_tests() {
    local python=$venv/bin/python failed=0 beside=() types workers=$((2 * $(nproc) + 1))
    unset PYTHONDONTWRITEBYTECODE # hundreds of processes would each compile all that they import
    # Most tests wait for ROS most of the time, so there are more of them at once than there are cores. Those that need
    # the cores wait for each other (tests/admission.py), so there is one process more, or a core is idle meanwhile.
    # Their groups begin in the order of tests/selection.py, not by how many tests they have.
    case ${1:-} in
        '' | --full | --all | --changed)
            beside=(--numprocesses "$workers" --maxprocesses 8 --dist loadgroup --no-loadscope-reorder)
            ;;
    esac
    mkdir -p build
    "$python" -m mypy > build/mypy.log 2>&1 &
    types=$!
    trap 'kill "$types" 2> /dev/null || true' EXIT
    "$python" -m ruff check || failed=1
    "$python" -m ruff format --check || failed=1
    # Once here, or each of the processes beside each other compiles all tests.
    ((${#beside[@]} == 0)) || "$python" -m pytest --collect-only --quiet > build/collected.log 2>&1 || true
    "$python" -m pytest "${beside[@]}" "$@" || failed=$?
    wait "$types" || { cat build/mypy.log >&2 && failed=1; }
    exit "$failed"
}

main() {
    local system argument arguments=()
    system=$(uname -s)
    if [[ $system != Linux && ${1:-} != -h && ${1:-} != --help ]]; then # macOS has another bash, no realpath, no wheels
        only_failure "operating system" "$system" "the packages of ROS 2 that the course installs are made for Linux" \
            "on macOS: a Linux virtual machine or container; on Windows: wsl --install Ubuntu-24.04" "$@"
    fi
    if [[ -n ${PYTHON:-} ]]; then # a relative path starts at the caller's folder
        PYTHON=$(type -P -- "$PYTHON" || printf '%s' "$PYTHON")
        [[ $PYTHON != */* ]] || PYTHON=$(realpath --no-symlinks -- "$PYTHON")
    fi
    root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
    venv=$root/.venv
    stamp=$venv/course-kit-stamp
    log=build/set-up.log
    cd -- "$root"
    case ${1:-} in
        '' | --json) check "$@" ;;
        lab)
            for argument in "${@:2}"; do
                case $argument in
                    --with-grading) level=grading again="./environment-check.sh lab --with-grading" ;;
                    *) arguments+=("$argument") ;;
                esac
            done
            prepare
            start_lab "${arguments[@]}"
            ;;
        test)
            [[ -d tests ]] || die "the tests hold answers to every exercise, so the students' edition is without. \`lab\` opens the course."
            level=test again="./environment-check.sh test"
            prepare
            run_tests "${@:2}"
            ;;
        --add) # what `course grade` runs, with its own command line
            [[ ${2:-} == @(grading|test) ]] || die "--add takes a level, grading or test."
            level=$2 again=${3:-./environment-check.sh --add $2}
            set_up only_add
            ;;
        -h | --help) printf '%s\n' "$usage" ;;
        *)
            say "environment-check: unknown argument: $1"
            say "$usage"
            exit 2
            ;;
    esac
}

main "$@"
