from setuptools import find_packages, setup

package_name = 'my_robot_pkg'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        # 1. Install config/limiter.yaml in the folder config of the share folder.

        ('share/' + package_name + '/config', ['config/limiter.yaml']),

    ],
    entry_points={
        'console_scripts': [
            # 2. executable = package.module:function

            'speed_limiter = my_robot_pkg.limiter:main',

        ],
    },
)
