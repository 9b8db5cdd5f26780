# SPDX-License-Identifier: Apache-2.0
"""ros2 launch plvo_ros plvo.launch.py: odometry of the images of a driver or of ros2 bag play. docs/user/robots.md describes the
parameters."""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

# Topics of the node: argument, default, what it is.
TOPICS = {
    "colour": ("colour", "/camera/color/image_raw", "topic of sensor_msgs/msg/Image"),
    "depth": ("depth", "/camera/aligned_depth_to_color/image_raw", "topic of the same, registered to colour"),
    "camera_info": ("camera_info", "/camera/color/camera_info", "topic of the camera_info of colour"),
    "imu": ("imu_topic", "/camera/imu", "topic of sensor_msgs/msg/Imu"),
    "odom": ("odom", "odom", "topic of the odometry"),
}
# Parameters of the node, which are arguments of the same name: type, default, what it is.
PARAMETERS = {
    "base_frame": (str, "base_link", "frame of the base"),
    "odom_frame": (str, "odom", "frame that the odometry is in"),
    "base_camera": (str, "", "tx ty tz qx qy qz qw; empty: from tf"),
    "camera_imu": (str, "", "qx qy qz qw; empty: from tf"),
    "publish_tf": (bool, "true", "send the transform from odom_frame to base_frame"),
    "exact_sync": (bool, "false", "pair images of equal stamps alone"),
    "max_interval_s": (float, "0.02", "largest difference of the stamps in a pair"),
    "queue_size": (int, "10", "messages that wait"),
    "imu": (bool, "false", "use imu_topic"),
    "imu_wait_s": (float, "0.1", "how long a frame waits for the IMU"),
    "level": (bool, "false", "a level odom, by the accelerometer"),
    "depth_units_per_metre": (float, "1000.0", "of 16UC1"),
    "stamp_sigma_s": (float, "0.0", "error of the colour stamps"),
}


def generate_launch_description():
    arguments = [*TOPICS.values(), *((name, default, text) for name, (_, default, text) in PARAMETERS.items())]
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default, description=text) for name, default, text in arguments),
        Node(
            package="plvo_ros", executable="odometry", name="plvo", output="screen",
            remappings=[(topic, LaunchConfiguration(argument)) for topic, (argument, _, _) in TOPICS.items()],
            parameters=[{name: ParameterValue(LaunchConfiguration(name), value_type=type_)
                         for name, (type_, _, _) in PARAMETERS.items()}],
        ),
    ])
