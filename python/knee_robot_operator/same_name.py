"""Whether a page of the same name runs already: the ROS master would end it for a second one, and every tablet's STOP with it."""
import http.client
import sys
import xmlrpc.client

import rosgraph

_PATIENCE_S = 2.0


class _Hasty(xmlrpc.client.Transport):
    def make_connection(self, host):
        connection = http.client.HTTPConnection(host, timeout=_PATIENCE_S)
        self._connection = host, connection
        return connection


def own_name(default, arguments=None):
    """As rospy.init_node(default) will resolve it."""
    arguments = sys.argv if arguments is None else arguments
    given = rosgraph.names.load_mappings(arguments).get("__name", default)
    return rosgraph.names.ns_join(rosgraph.names.get_ros_namespace(argv=arguments), given)


def address_of(name):
    """Of the node that has this name and answers; "" where there is none: one that was killed is still in the master's list, and its port may be
    another one's by now."""
    try:
        address = rosgraph.Master(name).lookupNode(name)
    except (rosgraph.MasterError, OSError):
        return ""
    try:
        published = xmlrpc.client.ServerProxy(address, transport=_Hasty()).getPublications(name)[2]
    except TimeoutError:
        return address  # it stands still
    except (OSError, http.client.HTTPException, xmlrpc.client.Error, LookupError, TypeError):
        return ""
    return address if any(topic.startswith(name + "/") for topic, _kind in published) else ""
