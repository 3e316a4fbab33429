//! The macro that defines the messages of one direction from a table: ids, names, bodies and answers. An id is never
//! used again for another message.

/// A body in the form of an older message.
pub(crate) trait Older<T> {
    fn older(&self) -> T;
}

/// Defines an enum of messages with an explicit id each, and its encoding and decoding. A message of a later minor may
/// name an older one (`or`), which takes its place for a side that does not know it; its body must have an [`Older`] form for that.
macro_rules! messages {
    (
        $(#[$enum_doc:meta])*
        pub enum $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $id:literal since $since:literal $variant:ident $(($body:ty))? $(-> $answer:ident)? $(or $older:ident)?,
            )+
        }
    ) => {
        $(#[$enum_doc])*
        #[derive(Clone, Debug, PartialEq, Eq)]
        #[derive(serde::Serialize, serde::Deserialize)]
        pub enum $name {
            $( $(#[doc = $doc])+ $variant $(($body))?, )+
        }

        impl $name {
            /// Every message, in the order of the ids.
            pub const TABLE: &'static [$crate::schema::MessageRow] = &[
                $(
                    $crate::schema::MessageRow {
                        id: $id,
                        since: $since,
                        name: stringify!($variant),
                        doc: &[$($doc),+],
                        body: messages!(@shape $($body)?),
                        answer: messages!(@answer $($answer)?),
                    },
                )+
            ];

            /// The message's id on the wire.
            #[must_use]
            pub const fn id(&self) -> u8 {
                match self {
                    $( messages!(@pattern $variant $(, $body)?) => $id, )+
                }
            }

            /// The minor version that brought it.
            #[must_use]
            pub const fn since(&self) -> u8 {
                match self {
                    $( messages!(@pattern $variant $(, $body)?) => $since, )+
                }
            }

            /// The same for a side that speaks an older minor; `None` if that side knows neither the message nor one that
            /// takes its place.
            pub(crate) fn lowered(&self, minor: $crate::minor::Minor) -> Option<Self> {
                Some(match self {
                    $(
                        messages!(@bind value $variant $(, $body)?) => {
                            if !minor.has($since) {
                                return messages!(@older value minor $($older)?);
                            }
                            messages!(@lower value minor $variant $(, $body)?)
                        }
                    )+
                })
            }

            /// Writes the body into `buffer` and returns its length in bytes.
            pub(crate) fn encode_body(&self, buffer: &mut [u8]) -> Result<usize, $crate::FrameError> {
                match self {
                    $(
                        messages!(@bind value $variant $(, $body)?) => messages!(@encode value buffer $(, $body)?),
                    )+
                }
            }

            /// Reads a body; every byte of it must be used.
            ///
            /// # Errors
            /// [`Refusal::UnknownMessage`](crate::Refusal::UnknownMessage) for an id that is not in the table,
            /// [`Refusal::Malformed`](crate::Refusal::Malformed) for a body that is too short, too long or
            /// impossible.
            pub fn decode(id: u8, body: &[u8]) -> Result<Self, $crate::Refusal> {
                match id {
                    $( $id => messages!(@decode body $variant $(, $body)?), )+
                    id => Err($crate::Refusal::UnknownMessage { id }),
                }
            }
        }
    };
    (@shape) => { None };
    (@shape $body:ty) => { Some(<$body as $crate::schema::Wire>::SHAPE) };
    (@answer) => { None };
    (@answer $answer:ident) => { Some(stringify!($answer)) };
    (@pattern $variant:ident) => { Self::$variant };
    (@pattern $variant:ident, $body:ty) => { Self::$variant(_) };
    (@bind $value:ident $variant:ident) => { Self::$variant };
    (@bind $value:ident $variant:ident, $body:ty) => { Self::$variant($value) };
    (@older $value:ident $minor:ident) => { None };
    (@older $value:ident $minor:ident $older:ident) => {
        Self::$older($crate::message::Older::older($value)).lowered($minor)
    };
    (@lower $value:ident $minor:ident $variant:ident) => { Self::$variant };
    (@lower $value:ident $minor:ident $variant:ident, $body:ty) => {
        Self::$variant($crate::schema::Wire::lowered($value, $minor))
    };
    (@encode $value:ident $buffer:ident) => { Ok(0) };
    (@encode $value:ident $buffer:ident, $body:ty) => {
        postcard::to_slice($value, $buffer).map(|used| used.len()).map_err(|_| $crate::FrameError::TooLong)
    };
    (@decode $bytes:ident $variant:ident) => {
        if $bytes.is_empty() { Ok(Self::$variant) } else { Err($crate::Refusal::Malformed) }
    };
    (@decode $bytes:ident $variant:ident, $body:ty) => {
        match postcard::take_from_bytes::<$body>($bytes) {
            Ok((body, [])) => Ok(Self::$variant(body)),
            _ => Err($crate::Refusal::Malformed),
        }
    };
}
pub(crate) use messages;
