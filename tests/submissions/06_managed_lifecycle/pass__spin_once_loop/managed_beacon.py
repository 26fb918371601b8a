import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class BeaconNode(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')
        print('beacon created')

    def on_configure(self, previousState):
        print('configuring, was', previousState.label)
        self.myPublisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.myTimer = self.create_timer(1, self.timerCallback)
        return super().on_configure(previousState)

    def on_activate(self, previousState):
        print('activating')
        return super().on_activate(previousState)

    def on_deactivate(self, previousState):
        print('deactivating')
        return super().on_deactivate(previousState)

    def on_cleanup(self, previousState):
        print('cleaning up')
        self.myTimer.cancel()
        self.myTimer.destroy()
        self.myPublisher.destroy()
        self.destroy_timer(self.myTimer)
        self.destroy_lifecycle_publisher(self.myPublisher)
        return super().on_cleanup(previousState)

    def timerCallback(self):
        myMessage = String()
        myMessage.data = 'hello from the beacon'
        self.myPublisher.publish(myMessage)
        print('published', myMessage.data)


def main(args=None):
    rclpy.init(args=args)
    myNode = BeaconNode()
    while rclpy.ok():
        rclpy.spin_once(myNode)
    myNode.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
