"""Memory budgets that are reached: slamd goes on, stays within them, and says which and what is lost by it."""

import unittest

from harness import EndToEndTest

MAP_BYTES = 1_000_000
GRAPH_BYTES = CLOUD_BYTES = 65_536
A_KEYFRAME = 20_000  # at most, of what the graph keeps of one


class Budgets(EndToEndTest):
    def reached(self):
        """The status once all three budgets are reached."""
        status = self.client.status()
        back_end = status["health"]["back_end"]
        all_are = status["map"]["budget_reached"] and back_end["budget_reached"] and back_end["forgotten_clouds"] > 0
        return status if all_are else None

    def test_the_status_and_the_log_say_which_budgets_are_reached(self):
        daemon = self.start_daemon("--set", f"map.byte_budget={MAP_BYTES}", "--set", f"graph.byte_budget={GRAPH_BYTES}",
                                   "--set", f"graph.cloud_byte_budget={CLOUD_BYTES}")
        before = self.client.status()
        self.assertFalse(before["map"]["budget_reached"])
        self.assertFalse(before["health"]["back_end"]["budget_reached"])
        self.start_simulator("--duration", "60")
        status = self.await_value("all budgets to be reached", self.reached, 90.0)
        self.assertLessEqual(status["map"]["bytes"], MAP_BYTES)
        self.assertGreater(status["map"]["evicted_keyframes"], 0)
        back_end = status["health"]["back_end"]
        self.assertEqual(back_end["byte_budget"], GRAPH_BYTES)
        self.assertLess(back_end["bytes"], GRAPH_BYTES + A_KEYFRAME)
        self.assertGreater(back_end["left_out_keyframes"], 0)
        self.await_pose("poses all the same", lambda pose: pose["status"] == "TRACKING")
        for name in ("budget_map", "budget_loops", "budget_graph"):
            self.await_value(f"{name} in the log", lambda name=name: f"{name} state=reached" in daemon.output(), 20.0)
        self.assert_stops_cleanly(daemon)


if __name__ == "__main__":
    unittest.main()
