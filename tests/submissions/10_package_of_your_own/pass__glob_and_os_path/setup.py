import os
from glob import glob

from setuptools import setup

package_name = 'my_robot_pkg'
share = os.path.join('share', package_name)

setup(
    name=package_name,
    version='1.2.3',
    packages=[package_name],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        (share, ['package.xml']),
        (os.path.join(share, 'config'), glob('config/*.yaml')),
        (os.path.join(share, 'launch'), glob('launch/*')),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    extras_require={'test': ['pytest']},
    entry_points={
        'console_scripts': [
            'talker = my_robot_pkg.talker:main',
            'listener = my_robot_pkg.listener:main',
            'limiter = my_robot_pkg.limiter:main',
        ],
    },
)
