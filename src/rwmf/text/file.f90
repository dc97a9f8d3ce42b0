!> Reading of whole files as text.
module rwmf_text_file
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_loc, c_null_char, &
      c_ptr, c_size_t
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: i8
   use rwmf_text_strings, only: integer_to_text
   implicit none
   private

   public :: read_file, c_fopen, c_fclose

   ! allow(assumed-size): C strings are arrays of assumed size
   interface
      function c_fopen(path, mode) bind(c, name='fopen') result(stream)
         import :: c_char, c_ptr
         implicit none
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(in) :: mode(*)
         type(c_ptr) :: stream
      end function c_fopen

      function c_fread(bytes, size, count, stream) bind(c, name='fread') result(read_items)
         import :: c_ptr, c_size_t
         implicit none
         type(c_ptr), intent(in), value :: bytes
         integer(c_size_t), intent(in), value :: size
         integer(c_size_t), intent(in), value :: count
         type(c_ptr), intent(in), value :: stream
         integer(c_size_t) :: read_items
      end function c_fread

      function c_fclose(stream) bind(c, name='fclose') result(status)
         import :: c_int, c_ptr
         implicit none
         type(c_ptr), intent(in), value :: stream
         integer(c_int) :: status
      end function c_fclose
   end interface

contains

   !> Read all bytes of a regular file.
   !>
   !> Pipes and devices are rejected before they are opened, because a read could block for ever.
   !> Errors: no such file, not a regular file, empty, 2 GB or more, not readable.
   subroutine read_file(path, bytes, error)
      character(*), intent(in) :: path
      !! path of the file
      character(:), allocatable, intent(out) :: bytes
      !! the whole file; undefined after an error
      type(error_t), allocatable, intent(out) :: error
      integer(i8) :: size
      logical :: exists
      integer :: length
      integer :: stat

      inquire (file=path, exist=exists, size=size, iostat=stat)
      if (stat /= 0 .or. .not. exists .or. len_trim(path) == 0) then
         call fail(error, err_input, 'the file does not exist')
      else if (size <= 0) then
         ! also the reported size of anything but a regular file
         call fail(error, err_input, 'the file is empty or not a regular file')
      else if (size >= huge(length)) then
         call fail(error, err_input, 'the file has '//trim(integer_to_text(size)) &
            //' bytes: must be less than 2 GB')
      else
         length = int(size)
         allocate (character(length) :: bytes, stat=stat)
         if (stat == 0) then
            call read_bytes(path, bytes, error)
         else
            call fail(error, err_input, 'not enough memory for the file')
         end if
      end if
   end subroutine read_file

   !> Fill the text from the beginning of the file.
   !>
   !> C streams are used because Fortran units reject a file that another thread is reading.
   subroutine read_bytes(path, bytes, error)
      character(*), intent(in) :: path
      character(:), allocatable, intent(inout), target :: bytes
      !! has the length of the file
      type(error_t), allocatable, intent(out) :: error
      type(c_ptr) :: stream
      integer(c_size_t) :: length
      integer(c_int) :: status

      length = 0_c_size_t
      stream = c_fopen(path//c_null_char, 'rb'//c_null_char)
      if (c_associated(stream)) then
         length = c_fread(c_loc(bytes), 1_c_size_t, len(bytes, c_size_t), stream)
         status = c_fclose(stream)
         if (status /= 0_c_int) length = 0_c_size_t
      end if
      if (length < len(bytes, c_size_t)) then
         call fail(error, err_input, 'the file cannot be read: a folder, or no permission')
      end if
   end subroutine read_bytes

end module rwmf_text_file
