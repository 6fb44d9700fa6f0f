import asyncio

from tests.sims.rapid.runtime.bench import play, value

ECHO = """
    VAR socketdev server;
    VAR socketdev client;
    VAR string text;
    VAR string address;
    VAR num served;
    PROC main()
        SocketCreate server;
        SocketBind server, "192.168.125.1", 1025;
        SocketListen server;
        WHILE TRUE DO
            SocketAccept server, client \\ClientAddress:=address \\Time:=WAIT_MAX;
            serve;
        ENDWHILE
    ENDPROC
    PROC serve()
        WHILE TRUE DO
            SocketReceive client \\Str:=text \\Time:=WAIT_MAX;
            served := served + 1;
            SocketSend client \\Str:="<" + text + ">";
        ENDWHILE
    ERROR
        IF ERRNO = ERR_SOCK_CLOSED THEN
            SocketClose client;
            RETURN;
        ENDIF
    ENDPROC
"""


async def connect(system):
    return await system.host.network.connect("192.168.125.1", 1025, peer="192.168.125.50")


def test_a_server_answers_client_after_client():
    async def script(system):
        system.tasks["T_ROB1"].start()
        await asyncio.sleep(0.01)
        for _ in range(3):
            client = await connect(system)
            for word in (b"one", b"two"):
                await client.send(word)
                assert await client.receive(80) == b"<" + word + b">"
            client.close()
        await asyncio.sleep(0.01)
        assert value(system, "served") == 6
        assert value(system, "address") == "192.168.125.50"

    play(script, ECHO)
