"""The facade for people who know no ROS: `sailenv_ros.Agent` and what it stands on.

Importing this package imports no ROS; `sailenv_ros.ros.client.agent` does.
"""

from sailenv_ros.system.transport import require_shared_memory

require_shared_memory()
