# The simulator without ROS, for SAILenv clients (port 8085) and browsers (port 8090):
#   docker build -t sailenv_ros . && docker run --rm -p 8085:8085 -p 8090:8090 sailenv_ros
FROM debian:12-slim
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates g++ python3-dev python3-venv
WORKDIR /opt/sailenv_ros
COPY . .
ENV PATH=/opt/venv/bin:$PATH SAILENV_CACHE=/var/cache/sailenv_ros
RUN python3 -m venv /opt/venv && pip install --no-cache-dir --constraint constraints.txt '.[assets,bake]'
RUN sailenv setup
EXPOSE 8085 8090
CMD ["sailenv", "run", "--no-ros", "--host", "0.0.0.0", "--viewer-host", "0.0.0.0"]
