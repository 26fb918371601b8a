"""Start the temperature publisher and the subscriber together."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'temp_monitor_pkg'


def generate_launch_description() -> LaunchDescription:
    """
    Describe the two nodes and the launch arguments.

    :returns: the description that ``ros2 launch`` executes
    """
    default_config = PathJoinSubstitution(
        [FindPackageShare(PACKAGE), 'config', 'temp_monitor.yaml']
    )
    # A launch argument is a string; without the type, `threshold_c:=30` would become an integer.
    threshold_c = ParameterValue(LaunchConfiguration('threshold_c'), value_type=float)
    use_sim_time = ParameterValue(LaunchConfiguration('use_sim_time'), value_type=bool)
    config = LaunchConfiguration('config')
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                'config', default_value=default_config, description='File with the parameters.'
            ),
            DeclareLaunchArgument(
                'threshold_c',
                default_value='30.0',
                description='Warn about readings strictly above this [degree Celsius].',
            ),
            DeclareLaunchArgument(
                'use_sim_time',
                default_value='false',
                description='Take the time from the topic /clock.',
            ),
            Node(
                package=PACKAGE,
                executable='temp_publisher',
                parameters=[config, {'use_sim_time': use_sim_time}],
                output='screen',
            ),
            Node(
                package=PACKAGE,
                executable='temp_subscriber',
                parameters=[config, {'threshold_c': threshold_c, 'use_sim_time': use_sim_time}],
                output='screen',
            ),
        ]
    )
