#!/usr/bin/env python3
"""A client that is not ours: it knows the service only through server reflection.

Asks the coordinator what it can do, submits x^2 - 2 = 0 with the text of a Bertini input file,
sends the same request again, waits for the end and reads summary and solutions.
Usage: stranger.py ADDRESS   (HOST:PORT or unix:PATH)
"""

import json
import sys
import uuid

import grpc
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from grpc_reflection.v1alpha.proto_reflection_descriptor_database import (
    ProtoReflectionDescriptorDatabase,
)

SERVICE = "cognate.v1.ClientApi"
PROBLEM = b"""
INPUT
  variable_group x;
  function f;
  f = x^2 - 2;
END;
"""
PATIENCE_SECONDS = 600


class Stranger:
    """Calls any method of a service by its name, with messages made from reflection."""

    def __init__(self, address):
        # Over a Unix socket grpcio names the path as authority, which HTTP/2 servers in Rust refuse.
        self.channel = grpc.insecure_channel(
            address, options=[("grpc.default_authority", "localhost")]
        )
        self.database = ProtoReflectionDescriptorDatabase(self.channel)
        self.pool = DescriptorPool(self.database)
        self.service = self.pool.FindServiceByName(SERVICE)

    def call(self, name, **fields):
        """One call; a list of answers where the method streams, else one answer."""
        method = self.service.FindMethodByName(name)
        request = GetMessageClass(method.input_type)(**fields)
        kind = self.channel.unary_stream if method.server_streaming else self.channel.unary_unary
        function = kind(
            f"/{SERVICE}/{name}",
            request_serializer=lambda message: message.SerializeToString(),
            response_deserializer=GetMessageClass(method.output_type).FromString,
        )
        answer = function(request, timeout=PATIENCE_SECONDS, wait_for_ready=True)
        return list(answer) if method.server_streaming else answer

    def value(self, enumeration, name):
        """The number of a name in an enumeration."""
        kind = self.pool.FindEnumTypeByName(f"cognate.v1.{enumeration}")
        return kind.values_by_name[name].number


def check(holds, what):
    """Ends the script where something does not hold."""
    if not holds:
        sys.exit(f"stranger: {what}")


def main():
    """The whole conversation."""
    stranger = Stranger(sys.argv[1])
    services = stranger.database.get_services()
    for name in [SERVICE, "grpc.health.v1.Health"]:
        check(name in services, f"{name} is not among the services {list(services)}")

    request_id = str(uuid.uuid4())
    problem = {"text": {"name": "square_root.bertini", "content": PROBLEM}}
    first = stranger.call("Submit", request_id=request_id, problem=problem)
    again = stranger.call("Submit", request_id=request_id, problem=problem)
    check(first.job == again.job, f"one request made two jobs, {first.job} and {again.job}")
    jobs = [job.job for job in stranger.call("ListJobs").jobs]
    check(jobs.count(first.job) == 1, f"{first.job} is {jobs.count(first.job)} times in {jobs}")

    progress = stranger.call("Watch", job=first.job)
    check(progress, "the watch told nothing")
    solved = stranger.value("JobState", "JOB_STATE_SOLVED")
    check(progress[-1].state == solved, f"the job ended otherwise: {progress[-1]}")

    summary = json.loads(stranger.call("GetSummary", job=first.job).json)
    check(summary["paths"]["total"] == 2, f"two paths expected: {summary['paths']}")
    check(summary["solutions"]["distinct"] == 2, f"two solutions expected: {summary}")
    check(summary["solutions"]["real"] == 2, f"two real solutions expected: {summary}")

    solutions = stranger.call("StreamSolutions", job=first.job)
    values = sorted(value.re for solution in solutions for value in solution.variables)
    check(len(values) == 2, f"two values expected: {values}")
    for value, expected in zip(values, [-(2**0.5), 2**0.5]):
        check(abs(value - expected) < 1e-12, f"{value} is not {expected}")

    bad = {"text": {"name": "bad.bertini", "content": b"INPUT variable_group x; function f; f = (x; END;"}}
    try:
        stranger.call("Submit", request_id=str(uuid.uuid4()), problem=bad)
        check(False, "a missing bracket was accepted")
    except grpc.RpcError as error:
        check(error.code() == grpc.StatusCode.INVALID_ARGUMENT, f"wrong code: {error.code()}")
    print(f"stranger: job {first.job}, solutions {values}")


if __name__ == "__main__":
    main()
