!> Motion of the floors and storeys of a frame whose floors have states.
module rwmf_model_floor_motion
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: frame_acceleration, frame_motion, model_t
   implicit none
   private

   public :: floor_motion, floor_accelerations, storey_motion, storey_accelerations

contains

   !> Compute displacements and velocities of ground, floors and roof relative to the ground.
   pure subroutine floor_motion(model, side, y, u, v)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:)
      !! states
      real(wp), intent(out) :: u(0:)
      !! (0:n) [m]
      real(wp), intent(out) :: v(:)
      !! (n) [m/s]

      u(0) = 0
      associate (first => model%floors%first, n => model%floors%free)
         u(1:n) = y(first:first + n - 1)
         v(:n) = y(first + n:first + 2*n - 1)
         if (n < size(v)) call frame_motion(model, side, y, u(n + 1), v(n + 1))
      end associate
   end subroutine floor_motion

   !> Compute the displacements of the storeys and their rates.
   pure subroutine storey_motion(model, side, y, d, d_dot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(out) :: d(:)
      !! (n) u_i - u_(i-1) [m]
      real(wp), intent(out) :: d_dot(:)
      !! (n) [m/s]
      real(wp) :: u(0:size(d))
      real(wp) :: v(size(d))
      integer :: n

      n = size(d)
      call floor_motion(model, side, y, u, v)
      d = u(1:) - u(:n - 1)
      d_dot = v
      d_dot(2:) = v(2:) - v(:n - 1)
   end subroutine storey_motion

   !> Accelerations of the floors relative to the ground.
   pure function floor_accelerations(model, side, y, y_dot) result(u_ddot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) states and their rates
      real(wp) :: u_ddot(model%floors%n)
      !! [m/s2]

      associate (first => model%floors%first, n => model%floors%free)
         u_ddot(:n) = y_dot(first + n:first + 2*n - 1)
         if (n < model%floors%n) u_ddot(n + 1) = frame_acceleration(model, side, y, y_dot)
      end associate
   end function floor_accelerations

   !> Second derivatives of the displacements of the storeys.
   pure function storey_accelerations(model, side, y, y_dot) result(d_ddot)
      class(model_t), intent(in) :: model
      integer, intent(in) :: side
      !! current side, +1 or -1
      real(wp), intent(in) :: y(:), y_dot(:)
      !! (states) states and their rates
      real(wp) :: d_ddot(model%floors%n)
      !! [m/s2]

      d_ddot = floor_accelerations(model, side, y, y_dot)
      associate (n => model%floors%n)
         d_ddot(2:) = d_ddot(2:) - d_ddot(:n - 1)
      end associate
   end function storey_accelerations

end module rwmf_model_floor_motion
