"""The app in a browser: pages over analyses and studies. It holds no physics, and nothing else imports it."""
