# SPDX-License-Identifier: Apache-2.0
"""The package plvo_ros as a user of ROS 2 builds it: an installed plvo, a workspace, colcon and ament. What Debian does not have of
ROS 2 is replaced: rclcpp, message_filters and tf2 by the stand-ins of this folder, launch and launch_ros by classes that keep what they are
given."""
import os
import pathlib
import re
import subprocess
import sys
import types
import xml.etree.ElementTree

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from user_pages import ROOT, blocks

BUILD, MADE, CMAKE = (pathlib.Path(os.environ[name]) for name in ("PLVO_BUILD", "PLVO_MADE", "PLVO_CMAKE"))
SOURCES = ROOT / "platform/plvo/ros2"
PAGE = (ROOT / "docs/user/robots.md").read_text(encoding="utf-8").partition("\n## A node for ROS 2")[2].partition("\n## ")[0]
BLOCKS = blocks(PAGE)
MESSAGES = ("diagnostic_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "std_srvs")
STAND_INS = ("message_filters", "rclcpp", "tf2", "tf2_ros")


@pytest.fixture(scope="module")
def prefixes(tmp_path_factory):
    """An installed plvo, and the packages of ROS 2 as folders that CMake finds."""
    folder = tmp_path_factory.mktemp("installed")
    for component in ("library", "development"):
        subprocess.run([CMAKE, "--install", BUILD, "--prefix", folder / "plvo", "--component", component], check=True,
                       env={name: value for name, value in os.environ.items() if name != "DESTDIR"}, stdout=subprocess.DEVNULL)
    runtime = [f"/usr/include/rosidl_{name}" for name in ("runtime_cpp", "runtime_c", "typesupport_interface")]
    for package in (*MESSAGES, *STAND_INS):
        include = [MADE / "messages/include", *runtime]
        if package in STAND_INS:
            include += [MADE / "stand_ins", ROOT / "tests/ros2/stand_ins"]
        config = folder / "ros" / "share" / package / "cmake" / f"{package}Config.cmake"
        config.parent.mkdir(parents=True)
        config.write_text(f"set({package}_INCLUDE_DIRS {' '.join(map(str, include))})\n")
    return folder


def test_the_steps_of_the_page_build_the_package(prefixes, tmp_path):
    (steps,) = (block for block in BLOCKS if "colcon build" in block)
    assert "cp -r /usr/src/plvo_ros" in steps
    environment = {**os.environ, "PATH": "/usr/bin:/bin", "CMAKE_PREFIX_PATH": f"{prefixes}/plvo:{prefixes}/ros", "CXXFLAGS": "-Wall -Wextra -Werror",
                   "COLCON_LOG_PATH": str(tmp_path / "log")}
    script = steps.replace("/usr/src/plvo_ros", str(prefixes / "plvo/src/plvo_ros")) + "\necho $AMENT_PREFIX_PATH"
    done = subprocess.run(["sh", "-e", "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    installed = tmp_path / "ws/install/plvo_ros"
    assert str(installed) in done.stdout.splitlines()[-1]
    assert (installed / "share/plvo_ros/package.xml").exists() and (installed / "share/plvo_ros/launch/plvo.launch.py").exists()
    assert (installed / "share/ament_index/resource_index/packages/plvo_ros").exists()
    node = installed / "lib/plvo_ros/odometry"
    done = subprocess.run([node], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, ""), "the node starts with the shared library, and the stand-in of spin returns"


# --- the launch file ---------------------------------------------------------------------------------------------------------------------

class Kept:
    """A class of launch or launch_ros: its arguments."""

    def __init__(self, *words, **named):
        self.words, self.named = words, named


@pytest.fixture
def launch(monkeypatch):
    """The arguments of the launch file, by name, and its node."""
    classes = {"launch": "LaunchDescription", "launch.actions": "DeclareLaunchArgument", "launch.substitutions": "LaunchConfiguration",
               "launch_ros": "", "launch_ros.actions": "Node", "launch_ros.parameter_descriptions": "ParameterValue"}
    for module, name in classes.items():
        monkeypatch.setitem(sys.modules, module, types.ModuleType(module))
        if name:
            setattr(sys.modules[module], name, type(name, (Kept,), {}))
    names = {}
    exec(compile((SOURCES / "plvo.launch.py").read_text(encoding="utf-8"), "plvo.launch.py", "exec"), names)  # as launch does
    *arguments, node = names["generate_launch_description"]().words[0]
    return {argument.words[0]: argument.named for argument in arguments}, node.named


def test_the_launch_file_has_the_arguments_of_ros_1(launch):
    arguments, node = launch
    tree = xml.etree.ElementTree.parse(ROOT / "platform/plvo/ros1/plvo.launch").getroot()
    of_ros_1 = {argument.get("name"): argument.get("default") for argument in tree.findall("arg")}

    def value(text):
        try:
            return float(text)
        except ValueError:
            return text
    assert {name: value(named["default_value"]) for name, named in arguments.items()} == {
        name: value(text) for name, text in of_ros_1.items()}
    (parameters,) = node["parameters"]
    assert set(parameters) == {param.get("name") for param in tree.find("node").findall("param")}
    for name, parameter in parameters.items():
        assert parameter.words[0].words == (name,)
    remapped = {topic: configuration.words[0] for topic, configuration in node["remappings"]}
    assert remapped == {remap.get("from"): remap.get("to")[6:-1] for remap in tree.find("node").findall("remap")}


def test_the_types_of_the_parameters_are_those_of_the_node(launch):
    """ROS 2 refuses a parameter of another type than the node declares."""
    _, node = launch
    (parameters,) = node["parameters"]
    text = "".join((ROOT / "platform/plvo/ros" / name).read_text(encoding="utf-8") for name in ("ros_node.hpp", "ros_odometry.hpp"))
    settings = "".join(re.findall(r"^struct Ros\w*Settings \{\n.*?^\};\n", text, re.M | re.S))
    for name, parameter in parameters.items():
        member = re.search(rf'read\("{name}", (?:odometry\.)?(\w+)\)', settings).group(1)
        declaration = re.search(rf"^  (std::string|bool|double|int) [^;()]*\b{member}\b", settings, re.M).group(1)
        assert parameter.named["value_type"] == {"std::string": str, "bool": bool, "double": float, "int": int}[declaration], name


def test_the_page_launches_what_there_is(launch):
    arguments, node = launch
    (block,) = (block for block in BLOCKS if "ros2 launch" in block)
    assert "ros2 launch plvo_ros plvo.launch.py" in block
    assert node["package"] == "plvo_ros" and node["executable"] == "odometry"
    assert set(re.findall(r"(\w+):=", block)) <= set(arguments)
