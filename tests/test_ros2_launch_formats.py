"""`ros2 launch` of XML and YAML files: the same launch, written in either, and both beside Python ones."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.ros2_launches import Prefix, RunningGroup

pytestmark = pytest.mark.by_turns("a program or a cell for each", of="cases")

NODE = {
    "xml": """
    <arg name="speed" default="1.5" description="How fast"/>
    <arg name="label" default="7"/>
    <arg name="nothing" default=""/>
    <let name="place" value="attic"/>
    <node pkg="demo" exec="reporter" name="driver" namespace="robot1" output="screen" ros_args="--log-level warn"
          args="--mode 'by hand' $(var place)" cwd="$(find-pkg-share demo)">
      <param from="$(find-pkg-share demo)/gains.yaml"/>
      <param from="$(find-pkg-share demo)/places.yaml" allow_substs="true"/>
      <param name="speed" value="$(var speed)"/>
      <param name="is_fast" value="true"/>
      <param name="quoted" value="'2'"/>
      <param name="label" value="$(var label)" type="str"/>
      <param name="nothing" value="$(var nothing)"/>
      <param name="rates" value="1.0, 2.5" value-sep=", "/>
      <param name="arm">
        <param name="length" value="2"/>
        <param name="tool"><param name="name" value="grip"/></param>
      </param>
      <env name="COLOUR" value="green"/>
      <remap from="chatter" to="/from_$(var place)"/>
    </node>
    """,
    "yaml": """
    - arg: {name: speed, default: "1.5", description: How fast}
    - arg: {name: label, default: "7"}
    - arg: {name: nothing, default: ""}
    - let: {name: place, value: attic}
    - node:
        pkg: demo
        exec: reporter
        name: driver
        namespace: robot1
        output: screen
        args: "--mode 'by hand' $(var place)"
        ros_args: --log-level warn
        cwd: $(find-pkg-share demo)
        param:
        - from: $(find-pkg-share demo)/gains.yaml
        - {from: $(find-pkg-share demo)/places.yaml, allow_substs: true}
        - {name: speed, value: $(var speed)}
        - {name: is_fast, value: true}
        - {name: quoted, value: '2'}
        - {name: label, value: $(var label), type: str}
        - {name: nothing, value: $(var nothing)}
        - {name: rates, value: [1.0, 2.5]}
        - name: arm
          param:
          - {name: length, value: 2}
          - {name: tool, param: [{name: name, value: grip}]}
        env:
        - {name: COLOUR, value: green}
        remap:
        - {from: chatter, to: /from_$(var place)}
    """,
}
TURTLES = {
    "xml": """
    <node pkg="turtlesim" exec="turtlesim_node" name="sim" namespace="turtlesim1"/>
    <node pkg="turtlesim" exec="turtlesim_node" name="sim" namespace="turtlesim2"/>
    <node pkg="turtlesim" exec="mimic" name="mimic">
      <remap from="/input/pose" to="/turtlesim1/turtle1/pose"/>
      <remap from="/output/cmd_vel" to="/turtlesim2/turtle1/cmd_vel"/>
    </node>
    """,
    "yaml": """
    - node: {pkg: turtlesim, exec: turtlesim_node, name: sim, namespace: turtlesim1}
    - node: {pkg: turtlesim, exec: turtlesim_node, name: sim, namespace: turtlesim2}
    - node:
        pkg: turtlesim
        exec: mimic
        name: mimic
        remap:
        - {from: /input/pose, to: /turtlesim1/turtle1/pose}
        - {from: /output/cmd_vel, to: /turtlesim2/turtle1/cmd_vel}
    """,
}
SCOPES = {
    "xml": """
    <set_env name="COLOUR" value="red"/>
    <group>
      <push_ros_namespace namespace="outer"/>
      <append_env name="COLOUR" value="blue" separator="+"/>
      <set_remap from="chatter" to="/whispers"/>
      <set_parameter name="gain" value="0.5"/>
      <set_parameters_from_file filename="$(find-pkg-share demo)/places.yaml"/>
      <node pkg="demo" exec="reporter" name="a" output="screen"/>
      <group><push-ros-namespace namespace="inner"/>
        <unset_env name="COLOUR"/><node pkg="demo" exec="reporter" name="b" output="screen"/></group>
    </group>
    <group scoped="false"><set_env name="COLOUR" value="pink"/></group>
    <let name="kept" value="c"/>
    <group forwarding="false"><keep name="kept" value="$(var kept)"/>
      <node pkg="demo" exec="reporter" name="$(var kept)" output="screen"/></group>
    <node pkg="demo" exec="reporter" name="d" output="screen"/>
    """,
    "yaml": """
    - set_env: {name: COLOUR, value: red}
    - group:
      - push_ros_namespace: {namespace: outer}
      - append_env: {name: COLOUR, value: blue, separator: +}
      - set_remap: {from: chatter, to: /whispers}
      - set_parameter: {name: gain, value: 0.5}
      - set_parameters_from_file: {filename: $(find-pkg-share demo)/places.yaml}
      - node: {pkg: demo, exec: reporter, name: a, output: screen}
      - group:
          children:
          - push-ros-namespace: {namespace: inner}
          - unset_env: {name: COLOUR}
          - node: {pkg: demo, exec: reporter, name: b, output: screen}
    - group: {scoped: false, children: [set_env: {name: COLOUR, value: pink}]}
    - let: {name: kept, value: c}
    - group:
        forwarding: false
        keep: [{name: kept, value: $(var kept)}]
        children: [node: {pkg: demo, exec: reporter, name: $(var kept), output: screen}]
    - node: {pkg: demo, exec: reporter, name: d, output: screen}
    """,
}
COURSE = {
    "xml": """
    <arg name="mode" default="slow"><choice value="slow"/><choice value="fast"/></arg>
    <executable cmd="echo &quot;two words&quot; $(var mode)" name="first" output="screen"/>
    <executable cmd="echo never" output="screen" unless="$(equals $(var mode) slow)"/>
    <executable cmd="echo $HOME | wc -l" name="shell" shell="true" output="screen"/>
    <timer period="0.2">
      <log message="late" if="$(eval '\\'$(var mode)\\' == \\'slow\\'')"/>
      <executable cmd="true" on_exit="shutdown"/>
      <timer period="60"><log message="never"/></timer>
    </timer>
    """,
    "yaml": """
    - arg: {name: mode, default: slow, choice: [{value: slow}, {value: fast}]}
    - executable: {cmd: 'echo "two words" $(var mode)', name: first, output: screen}
    - executable: {cmd: echo never, output: screen, unless: $(equals $(var mode) slow)}
    - executable: {cmd: echo $HOME | wc -l, name: shell, shell: true, output: screen}
    - timer:
        period: 0.2
        children:
        - log: {message: late, if: $(eval "'$(var mode)' == 'slow'")}
        - executable: {cmd: 'true', on_exit: shutdown}
        - timer: {period: 60.0, children: [log: {message: never}]}
    """,
}
OPENINGS = {"xml": "<launch>{}</launch>", "yaml": "launch:{}"}
BOTH = pytest.mark.parametrize("kind", ["xml", "yaml"])


@pytest.fixture
def prefix(tmp_path: Path) -> Prefix:
    prefix = Prefix(tmp_path / "install")
    share = prefix.package("demo")
    prefix.node("demo", "reporter")
    (share / "gains.yaml").write_text("/**:\n  ros__parameters:\n    gain: 0.25\n    speed: 1.0\n")
    (share / "places.yaml").write_text("/**:\n  ros__parameters:\n    place: up in the $(var place attic)\n")
    return prefix


def write(prefix: Prefix, kind: str, body: str, name: str = "demo") -> Path:
    path = prefix.package("demo") / f"{name}.launch.{kind}"
    path.write_text(OPENINGS[kind].format(body))
    return path


def launch(prefix: Prefix, kind: str, body: str, *words: str) -> RunningGroup:
    write(prefix, kind, body)
    return RunningGroup("launch", "demo", f"demo.launch.{kind}", *words, environment=prefix.environment)


def logged(running: RunningGroup) -> list[str]:
    assert running.end().status == 0, running.text
    return [line.partition("[launch.user]: ")[2] for line in running.lines if "[launch.user]: " in line]


def refused(prefix: Prefix, kind: str, body: str) -> str:
    with launch(prefix, kind, body) as running:
        assert running.end().status == 1, running.text
    (line,) = running.lines[2:]
    return line


@BOTH
def test_all_that_a_node_is_given_reaches_it(prefix: Prefix, kind: str) -> None:
    with launch(prefix, kind, NODE[kind], "speed:=2.5") as running:
        (report,) = running.reports()
    own = ("use_sim_time", "start_type_description_service")
    assert {name: value for name, value in report["parameters"].items() if name not in own} == {
        "gain": 0.25,
        "place": "up in the attic",
        "speed": 2.5,
        "is_fast": True,
        "quoted": "2",
        "label": "7",
        "nothing": "",
        "rates": [1.0, 2.5],
        "arm.length": 2,
        "arm.tool.name": "grip",
    }
    assert report["name"] == "/robot1/driver"
    assert report["chatter"] == "/from_attic"
    assert report["arguments"] == ["--mode", "by hand", "attic"]
    assert report["colour"] == "green"
    assert report["folder"] == str(prefix.package("demo"))


@BOTH
def test_groups_have_scopes(prefix: Prefix, kind: str) -> None:
    with launch(prefix, kind, SCOPES[kind]) as running:
        reports = {report["name"]: report for report in running.reports(4)}
    colours = {name: report["colour"] for name, report in reports.items()}
    assert colours == {"/outer/a": "red+blue", "/outer/inner/b": None, "/c": None, "/d": "pink"}
    assert [reports[name]["chatter"] for name in ("/outer/inner/b", "/d")] == ["/whispers", "/chatter"]
    given = reports["/outer/inner/b"]["parameters"]
    assert given["gain"] == 0.5
    assert given["place"].startswith("up in the")
    assert "gain" not in reports["/d"]["parameters"]


@BOTH
def test_conditions_timers_and_shutdown_act(prefix: Prefix, kind: str) -> None:
    with launch(prefix, kind, COURSE[kind]) as running:
        assert logged(running) == ["late"]
        assert {"[first-1] two words slow", "[shell-2] 1"} <= set(running.lines)
        assert "never" not in running.text


@BOTH
def test_arguments_are_shown_and_checked(prefix: Prefix, kind: str) -> None:
    with launch(prefix, kind, NODE[kind], "-s") as running:
        assert running.end().status == 0
        assert running.lines[:7] == [
            "Arguments (pass arguments as '<name>:=<value>'):",
            "",
            "    'speed':",
            "        How fast",
            "        (default: '1.5')",
            "",
            "    'label':",
        ]
    with launch(prefix, kind, COURSE[kind], "mode:=odd") as running:
        assert running.end().status == 1
        assert "mode:=odd is none of the choices" in running.lines[-1]


@pytest.mark.parametrize("outer", ["xml", "yaml", "py"])
@pytest.mark.parametrize("inner", ["xml", "yaml", "py"])
def test_each_format_includes_each(prefix: Prefix, outer: str, inner: str) -> None:
    bodies = {
        "xml": '<arg name="place" description="Where"/><log message="in $(var place), $(dirname)"/>',
        "yaml": "\n- arg: {name: place, description: Where}\n- log: {message: 'in $(var place), $(dirname)'}",
        "py": 'DeclareLaunchArgument("place", description="Where"), '
        'LogInfo(msg=["in ", LaunchConfiguration("place"), ", ", ThisLaunchFileDir()])',
    }
    path = f"$(find-pkg-share demo)/inner.launch.{inner}"
    includes = {
        "xml": f'<include file="{path}"><arg name="place" value="the attic"/></include>',
        "yaml": f"\n- include:\n    file: {path}\n    arg: [{{name: place, value: the attic}}]",
        "py": f'IncludeLaunchDescription(PathJoinSubstitution([FindPackageShare("demo"), "inner.launch.{inner}"]), '
        'launch_arguments={"place": "the attic"}.items())',
    }
    for name, kind, body in (("inner", inner, bodies[inner]), ("outer", outer, includes[outer])):
        if kind == "py":
            prefix.launch_file("demo", f"{name}.launch.py", body)
        else:
            write(prefix, kind, body, name)
    words = ("launch", "demo", f"outer.launch.{outer}")
    with RunningGroup(*words, environment=prefix.environment) as running:
        assert logged(running) == [f"in the attic, {prefix.package('demo')}"]
    with RunningGroup(*words, "--show-args", environment=prefix.environment) as running:
        assert running.end().status == 0
        assert running.lines[2:4] == ["    'place':", "        Where"]


def test_python_files_name_the_other_formats(prefix: Prefix) -> None:
    path = write(prefix, "xml", '<log message="from XML"/>', "inner")
    prefix.launch_file(
        "demo",
        "demo.launch.py",
        f"""*[IncludeLaunchDescription(source({str(path)!r})) for source in (
            __import__("launch_xml.launch_description_sources").launch_description_sources.XMLLaunchDescriptionSource,
            FrontendLaunchDescriptionSource)],""",
    )
    with RunningGroup("launch", "demo", "demo.launch.py", environment=prefix.environment) as running:
        assert logged(running) == ["from XML"] * 2


def test_a_file_of_another_name_is_known_by_its_beginning(prefix: Prefix) -> None:
    xml = '<?xml version="1.0"?>\n<launch deprecated="it is old"><log message="here"/></launch>'
    for text, warns in ((xml, True), ("launch: [log: {message: here}]", False)):
        path = prefix.folder / "demo.launch"
        path.write_text(text)
        with RunningGroup("launch", path, environment=prefix.environment) as running:
            assert logged(running) == ["here"]
            assert (f"{path} is out of date: it is old" in running.text) == warns


@pytest.mark.parametrize("kind", TURTLES)
def test_the_tutorial_s_turtlesim_starts(prefix: Prefix, kind: str) -> None:
    with launch(prefix, kind, TURTLES[kind]) as running:
        running.wait_for(r"^\[turtlesim_node-\d\] .*Spawning turtle \[turtle1\]", 2)
        assert len(running.pids(3)) == 3
        running.interrupt()
        assert running.end().status == 0


SUBSTITUTIONS = {
    "plain": "plain",
    r"\$(var a) costs $5 \\": "$(var a) costs $5 \\",
    "$(var a)$(var a)": "oneone",
    "$(var missing 'a default')": "a default",
    "$(var taken_away 'by unset')": "by unset",
    "$(var missing $(var a))": "one",
    "$(env COLOUR)-$(env NOPE '')-$(env NOPE none)": "red--none",
    "$(eval '1 + 2')$(eval \"'$(var a)' == 'one'\")": "3True",
    "$(eval 'math.floor(2.5) + pi > 5 ')": "True",
    "$(eval 'json.dumps([])' json)": "[]",
    "$(command 'echo hi there')": "hi there",
    "$(find-exec sh)": "SH",
    "$(find-pkg-prefix demo) $(find-pkg-share demo)": "P P/share/demo",
    "$(exec-in-pkg reporter demo)": "P/lib/demo/reporter",
    "$(filename)": "P/share/demo/demo.launch.yaml",
    "$(dirname)": "P/share/demo",
    "$(not true) $(and true false) $(or true false) $(any false true) $(all false true)": "false false true true false",
    "$(equals $(var a) one) $(not-equals a b)": "true true",
    "$(if $(equals 1 1) yes no)": "yes",
    "$(file-content $(dirname)/note.txt)": "a note",
    "$(eval \"'$(anon talker)'.startswith('talker_') and '$(anon talker)' == '$(anon talker)'\")": "True",
    "$(eval \"'$(log_dir)'.startswith('$(env ROS_LOG_DIR)')\")": "True",
}


def test_substitutions_give_their_texts(prefix: Prefix) -> None:
    (prefix.package("demo") / "note.txt").write_text("a note")
    lines = [f"- log: {{message: '|{text.replace(chr(39), chr(39) * 2)}'}}" for text in SUBSTITUTIONS]
    values = ["- let: {name: a, value: one}", "- let: {name: taken_away, value: a}", "- unset: {name: taken_away}"]
    body = "\n".join(["", *values, "- set_env: {name: COLOUR, value: red}", *lines])
    with launch(prefix, "yaml", body) as running:
        said = [line.removeprefix("|") for line in logged(running)]
    shell = next(f"{folder}/sh" for folder in os.environ["PATH"].split(":") if os.access(f"{folder}/sh", os.X_OK))
    assert [text.replace(str(prefix.folder), "P").replace(shell, "SH") for text in said] == [*SUBSTITUTIONS.values()]


@pytest.mark.parametrize(
    ("kind", "body", "reason"),
    [
        ("xml", "<nod/>", "`nod` is no tag of a launch file (did you mean node?)"),
        ("xml", "<node>", "mismatched tag"),
        ("xml", "words", "`launch` holds tags, not text such as 'words'"),
        ("xml", "<node pkg='demo'/>", "`node` lacks its 'exec'"),
        ("xml", "<node exec='a' pkgs='demo'/>", "`node` takes no attribute 'pkgs'"),
        ("xml", "<node exec='a'><parm/></node>", "`node` takes no tag 'parm'"),
        ("xml", "<node exec='a'><param name='b'/></node>", "`param` lacks its 'value'"),
        ("xml", "<node exec='a'><param name='b' from='c'/></node>", "both 'name' and 'from'"),
        ("xml", "<node exec='a'><param name='b' allow_substs='true' value='1'/></node>", "it goes with 'from'"),
        ("xml", "<node exec='a'><param name='b' value='1' type='real'/></node>", "it can be bool, float, int, str"),
        ("xml", "<node exec='a' on_exit='restart'/>", "it can be 'shutdown' only"),
        ("xml", "<group scoped='maybe'/>", "'scoped' of `group` is 'maybe', not true or false"),
        ("xml", "<timer period='soon'/>", "could not convert string to float: 'soon'"),
        ("xml", "<log message='' if='true' unless='true'/>", "has both 'if' and 'unless'"),
        ("xml", "<log message='' if='perhaps'/>", "a condition is true, 1, false or 0"),
        ("xml", "<log message='$(var a'/>", "'$(var a' lacks the closing bracket"),
        ("xml", "<log message='$(eval \"a)'/>", "A quote is not closed in"),
        ("xml", "<log message='$()'/>", "No name of a substitution behind '$('"),
        ("xml", "<log message='$(arg a)'/>", "$(arg ...) is no substitution"),
        ("xml", "<log message='$(var)'/>", "$(var ...) takes 1 to 2 arguments, not 0"),
        ("xml", "<log message='$(var nope)'/>", "nothing has set the launch configuration 'nope'"),
        ("xml", "<log message='$(file-content /nope)'/>", "cannot read /nope"),
        ("xml", "<include file='/nope.launch.xml'/>", "'/nope.launch.xml': "),
        ("xml", "<set_parameters_from_file filename='/nope'/>", "there is no file '/nope'"),
        ("xml", "<include file='$(find-pkg-share demo)/demo.launch.xml'/>", "does a launch file include itself?"),
        ("xml", "<node_container/>", "<node_container> is not covered here: it needs the real `ros2 launch`"),
        ("xml", "<log message='$(param a)'/>", "the substitution $(param ...) is not covered here"),
        ("yaml", "\n- node", "Expected one tag with a colon behind it, got 'node'"),
        ("yaml", "\n- node: here", "Expected the attributes of `node`, got 'here'"),
        ("yaml", "\n- arg: {name: a, default: 5}", "'default' of `arg` is 5, not a text"),
        ("yaml", "\n- node: {", "while parsing a flow node"),
        ("yaml", " []\nmore: []", "Expected one tag"),
        ("yaml", "\n- 5: {}", "Expected one tag with a colon behind it, got {5: {}}"),
        ("yaml", "\n- group: {children: 5}", "'children' of `group` is 5, not a list of tags"),
        ("yaml", "\n- include: {file: $(dirname)/note.yaml}", "The outermost tag is `robot`, not `launch`"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(prefix: Prefix, kind: str, body: str, reason: str) -> None:
    (prefix.package("demo") / "note.yaml").write_text("robot: []")
    line = refused(prefix, kind, body)
    assert line.startswith("[ERROR] [launch]: Caught exception in launch (see debug for traceback): ")
    assert reason in line
