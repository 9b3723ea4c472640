//! Messages as bytes: a header with their length, and JSON.

use std::io::{self, BufRead, Read, Write};

use lsp_server::{ErrorCode, Message, RequestId, ResponseError};
use serde::Serialize;
use serde_json::{Value, json};

use super::{outbox::refused, work::Result};

/// The longest line of a header.
const LONGEST_LINE: u64 = 1 << 12;
/// The longest message.
const LONGEST: u64 = 1 << 30;

/// What was read.
#[derive(Debug)]
pub(super) enum Incoming {
    Message(Message),
    /// The answer to something that is not a message.
    Malformed(Value),
}

/// Reads the next message; `None` at the end of the input.
pub(super) fn read(input: &mut impl BufRead) -> io::Result<Option<Incoming>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        let read = input
            .by_ref()
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line)?;
        if read == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        if line.is_empty() {
            break;
        }
        if let Some((name, value)) = line.split_once(':')
            && name.trim().eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().ok();
        }
    }
    let Some(length) = length.filter(|length| *length <= LONGEST) else {
        let message = "expected a header with a `Content-Length` of at most 1 GiB";
        return Ok(Some(malformed(None, ErrorCode::ParseError, message)));
    };
    let mut body = Vec::new();
    // What the header claims is not reserved: it may be wrong.
    if input.by_ref().take(length).read_to_end(&mut body)? as u64 != length {
        return Ok(None);
    }
    Ok(Some(parse(&body)))
}

fn parse(body: &[u8]) -> Incoming {
    let value: Value = match serde_json::from_slice(body) {
        Ok(value) => value,
        Err(error) => {
            return malformed(None, ErrorCode::ParseError, &error.to_string());
        }
    };
    let id = value.get("id").cloned();
    match serde_json::from_value(value) {
        // Its id is neither a number nor a string.
        Ok(Message::Notification(_)) if id.is_some() => {
            malformed(None, ErrorCode::InvalidRequest, "the id is not valid")
        }
        Ok(message) => Incoming::Message(message),
        Err(_) => malformed(
            id,
            ErrorCode::InvalidRequest,
            "not a message of the protocol",
        ),
    }
}

fn malformed(id: Option<Value>, code: ErrorCode, message: &str) -> Incoming {
    let id = id.filter(|id| serde_json::from_value::<RequestId>(id.clone()).is_ok());
    Incoming::Malformed(json!({
        "jsonrpc": "2.0",
        "id": id,
        "error": {"code": code as i32, "message": message},
    }))
}

/// Writes a message in JSON.
pub(super) fn write(output: &mut impl Write, message: &[u8]) -> io::Result<()> {
    write!(output, "Content-Length: {}\r\n\r\n", message.len())?;
    output.write_all(message)?;
    output.flush()
}

#[derive(Serialize)]
struct Reply<'a, T> {
    jsonrpc: &'static str,
    id: &'a RequestId,
    #[serde(flatten)]
    result: ReplyResult<T>,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum ReplyResult<T> {
    Result(T),
    Error(ResponseError),
}

/// Returns a response in JSON. It is not a [`Value`] in between, which takes 30 times as much memory.
pub(super) fn response<T: Serialize>(id: &RequestId, result: Result<T>) -> Vec<u8> {
    let message = Reply {
        jsonrpc: "2.0",
        id,
        result: result.map_or_else(ReplyResult::Error, ReplyResult::Result),
    };
    serde_json::to_vec(&message).unwrap_or_else(|error| {
        let error = refused(ErrorCode::InternalError, error.to_string());
        response::<()>(id, Err(error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(mut bytes: &[u8]) -> Vec<String> {
        let mut found = Vec::new();
        while let Some(incoming) = read(&mut bytes).unwrap() {
            found.push(match incoming {
                Incoming::Message(Message::Request(request)) => request.method,
                Incoming::Message(Message::Notification(notification)) => notification.method,
                Incoming::Message(Message::Response(response)) => response.id.to_string(),
                Incoming::Malformed(answer) => {
                    format!("{} {}", answer["id"], answer["error"]["code"])
                }
            });
        }
        found
    }

    fn framed(text: &str) -> Vec<u8> {
        format!("Content-Length: {}\r\n\r\n{text}", text.len()).into_bytes()
    }

    #[test]
    fn what_is_not_a_message_is_answered() {
        let bytes = [
            &framed("{\"method\": \"a\"}")[..],
            b"x: y\r\n\r\n",
            &framed("{\"id\": 1, \"method\": \"b\"}"),
            &framed("{"),
            &framed("[]"),
            &framed("{\"id\": 4}"),
            &framed("{\"id\": null, \"method\": \"c\"}"),
            b"Content-Length: 99999999999\r\n\r\n",
            &framed("{\"id\": \"x\", \"result\": 1}"),
            b"Content-Length: 9\r\n\r\n{",
        ]
        .concat();
        let expected = [
            "a",
            "null -32700",
            "b",
            "null -32700",
            "null -32600",
            "4 -32600",
            "null -32600",
            "null -32700",
            "\"x\"",
        ];
        assert_eq!(all(&bytes), expected);
    }
}
